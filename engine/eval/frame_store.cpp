// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/frame_store.h"

#include "engine/atomic_file.h"
#include "engine/eval/keys.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <random>
#include <unistd.h>

namespace sinew::engine {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t block = 4096;
constexpr std::size_t most_starts = 4;
/// Of a frame whose memory the next one takes over [bytes].
constexpr std::size_t most_room = std::size_t{64} << 20;
constexpr std::string_view rows_mark = "sinew rows 2\n";
constexpr std::string_view rows_ending = ".rows", frames_ending = ".frame", outputs_ending = ".kept";
/// From so many files of rows on one is made of those that nobody writes to any more.
constexpr std::size_t most_row_files = 32;

bool is_ours(const fs::path& file) {
    const std::string ending = file.extension().string();
    return ending == rows_ending || ending == frames_ending || ending == outputs_ending;
}

} // namespace

/// Sections begin at a block's edge, and each is told from the same one of the start frame: one that changes its length
/// moves none of the others.
struct LaidFrame {
    std::vector<std::byte> bytes;
    std::vector<std::uint32_t> first_block; ///< of each section

    /// What `write` appends to the frame's own bytes: frames are large, and memory that is new to the process is slow.
    template <class Write>
    void put(const Write& write) {
        bytes.resize((bytes.size() + block - 1) / block * block);
        first_block.push_back(static_cast<std::uint32_t>(bytes.size() / block));
        const std::size_t at = bytes.size();
        ByteWriter out;
        out.bytes = std::move(bytes);
        out.put(std::uint64_t{0});
        write(out);
        bytes = std::move(out.bytes);
        const std::uint64_t size = bytes.size() - at - sizeof(std::uint64_t);
        std::memcpy(bytes.data() + at, &size, sizeof size);
    }
    /// With its length, to where the next one begins; nothing beyond the last.
    std::span<const std::byte> section(std::size_t k) const {
        if (k >= first_block.size()) return {};
        const std::size_t first = std::size_t{first_block[k]} * block;
        const std::size_t end = k + 1 < first_block.size() ? std::size_t{first_block[k + 1]} * block : bytes.size();
        return std::span(bytes).subspan(first, end - first);
    }
};

namespace {

class Sections {
  public:
    explicit Sections(const LaidFrame& of)
        : of_(of) {}
    /// A copy, or an empty one where it is not wanted.
    std::vector<std::byte> next(bool wanted = true) {
        ByteReader in(of_.section(next_++));
        const auto size = in.get<std::uint64_t>();
        if (size > in.rest.size()) throw BadBytes("it ends too early");
        const auto part = in.rest.first(size);
        std::vector<std::byte> out;
        if (wanted) out.assign(part.begin(), part.end());
        return out;
    }

  private:
    const LaidFrame& of_;
    std::size_t next_ = 0;
};

void put_warnings(ByteWriter& out, const std::vector<Diagnostic>& warnings) {
    out.put<std::uint64_t>(warnings.size());
    for (const Diagnostic& d : warnings) // places are those of the graph that reads it
        for (const std::string* text : {&d.code, &d.attribute, &d.message, &d.hint}) out.put_text(*text);
}

std::vector<Diagnostic> get_warnings(ByteReader& in) {
    std::vector<Diagnostic> out;
    const auto count = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
        Diagnostic d;
        d.severity = Severity::warning;
        for (std::string* text : {&d.code, &d.attribute, &d.message, &d.hint}) *text = in.get_text();
        out.push_back(std::move(d));
    }
    return out;
}

/// What it was made from, its state, each output, its warnings.
void encode(const Registry& registry, const NodeType& type, const KeptFrame& frame, LaidFrame& out) {
    out.bytes.clear(), out.first_block.clear();
    out.put([&](ByteWriter& made_from) {
        made_from.put(identity(type).finish());
        made_from.put<std::int64_t>(frame.frame);
        made_from.put_text(frame.made_from.node);
        made_from.put<std::uint64_t>(frame.made_from.contents.size());
        for (const auto& [plug, content] : frame.made_from.contents) made_from.put_text(plug), made_from.put(content);
    });
    out.put([&](ByteWriter& state) { state.bytes.insert(state.bytes.end(), frame.state.begin(), frame.state.end()); });
    for (std::size_t i = 0; i < type.outputs.size(); ++i)
        out.put([&](ByteWriter& output) {
            const Codec* codec = registry.find_codec(type.outputs[i].type);
            output.put<std::uint8_t>(codec != nullptr);
            output.put(frame.entry->digest(i));
            if (!codec) return;
            output.put_text(codec->type_name);
            output.put<std::int64_t>(codec->version);
            codec->write(frame.entry->outputs[i], output);
        });
    out.put([&](ByteWriter& warnings) {
        put_warnings(warnings, frame.entry->warnings);
        put_warnings(warnings, frame.warnings_of_state);
    });
}

void read_made_from(std::span<const std::byte> bytes, KeptFrame& out, Digest& type) {
    ByteReader in(bytes);
    type = in.get<Digest>();
    out.frame = static_cast<int>(in.get<std::int64_t>());
    out.made_from.node = in.get_text();
    const auto count = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
        std::string plug = in.get_text();
        out.made_from.contents.emplace_back(std::move(plug), in.get<Digest>());
    }
}

KeptFrame decode(const Registry& registry, const NodeType& type, const LaidFrame& frame, bool with_state) {
    KeptFrame out;
    Sections sections(frame);
    Digest made_by;
    read_made_from(sections.next(), out, made_by);
    if (made_by != identity(type).finish()) throw BadBytes("it was made by another version of the program");
    out.state = sections.next(with_state);
    Entry entry;
    bool whole = true;
    for (const AttributeInfo& info : type.outputs) {
        const std::vector<std::byte> section = sections.next();
        ByteReader in(section);
        const bool there = in.get<std::uint8_t>() != 0;
        const auto digest = in.get<Digest>();
        entry.known.push_back(digest);
        const Codec* codec = registry.find_codec(info.type);
        Value value;
        if (there && codec && in.get_text() == codec->type_name && in.get<std::int64_t>() == codec->version) {
            value = codec->read(in);
            if (value.digest() != digest) throw BadBytes("what it gives is not what was kept");
        }
        whole = whole && value;
        entry.outputs.push_back(std::move(value));
    }
    const std::vector<std::byte> warnings = sections.next();
    ByteReader in(warnings);
    entry.warnings = get_warnings(in);
    out.warnings_of_state = get_warnings(in);
    if (whole) entry.known.clear();
    out.entry = std::make_shared<const Entry>(std::move(entry));
    return out;
}

/// How many bytes of a section's block b there are; it is cut at the section's end.
std::size_t bytes_of(std::span<const std::byte> section, std::size_t b) {
    return std::min(block, section.size() - b * block);
}

/// The blocks of a frame that are not those of the start frame at the same place of the same section.
std::vector<std::byte> differing(const LaidFrame& frame, const LaidFrame* start, const Digest& start_key) {
    ByteWriter out;
    out.put(start_key);
    out.put<std::uint64_t>(frame.bytes.size());
    out.put_list(frame.first_block);
    std::vector<std::uint32_t> others;
    for (std::size_t k = 0; k < frame.first_block.size(); ++k) {
        const auto section = frame.section(k), base = start ? start->section(k) : std::span<const std::byte>();
        for (std::size_t b = 0; b * block < section.size(); ++b) {
            const std::size_t count = bytes_of(section, b);
            const bool same = b * block + count <= base.size() &&
                              std::memcmp(section.data() + b * block, base.data() + b * block, count) == 0;
            if (!same) others.push_back(frame.first_block[k] + static_cast<std::uint32_t>(b));
        }
    }
    out.put_list(others);
    out.bytes.reserve(out.bytes.size() + others.size() * block);
    for (const std::uint32_t b : others) {
        const auto part = std::span(frame.bytes).subspan(std::size_t{b} * block, bytes_of(frame.bytes, b));
        out.bytes.insert(out.bytes.end(), part.begin(), part.end());
    }
    return std::move(out.bytes);
}

void append_rows(const fs::path& file, std::span<const PlugContent> rows) {
    ByteWriter out;
    out.put<std::uint64_t>(rows.size());
    for (const PlugContent& row : rows) out.put(row.plug), out.put(row.content);
    out.put(Hasher().add_bytes(out.bytes).finish());
    const auto fail = [&] {
        Diagnostic d;
        d.code = "IO405";
        d.message = "cannot write '" + file.string() + "': " + std::strerror(errno);
        d.hint = "check the folder's permissions and the free space";
        throw Failure(d);
    };
    const int descriptor = open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor < 0) fail();
    const std::string mark(lseek(descriptor, 0, SEEK_END) == 0 ? rows_mark : "");
    std::string text = mark;
    text.append(reinterpret_cast<const char*>(out.bytes.data()), out.bytes.size());
    const bool done = ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    close(descriptor);
    if (!done) fail();
}

/// All whole records; a writer that was killed may have left half of one at the end.
void read_row_file(const fs::path& file, const std::function<void(const PlugContent&)>& take) {
    std::ifstream stream(file, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    if (!text.starts_with(rows_mark)) return;
    ByteReader in(std::as_bytes(std::span(text)).subspan(rows_mark.size()));
    constexpr std::size_t row_size = 2 * sizeof(Digest);
    while (in.rest.size() >= sizeof(std::uint64_t) + sizeof(Digest)) {
        const std::span<const std::byte> record = in.rest;
        const auto count = in.get<std::uint64_t>();
        if (count > (in.rest.size() - sizeof(Digest)) / row_size) return;
        const std::size_t length = sizeof(std::uint64_t) + count * row_size;
        ByteReader sum(record.subspan(length));
        if (sum.get<Digest>() != Hasher().add_bytes(record.first(length)).finish()) return;
        for (std::uint64_t i = 0; i < count; ++i) {
            const auto plug = in.get<Digest>(), content = in.get<Digest>();
            take({plug, content});
        }
        in.rest = sum.rest;
    }
}

std::vector<fs::directory_entry> files_in(const fs::path& folder, std::string_view ending) {
    std::vector<fs::directory_entry> out;
    std::error_code error;
    // Links are none of ours, and may lead anywhere.
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (std::error_code gone;
            entry.path().extension() == ending && entry.symlink_status(gone).type() == fs::file_type::regular)
            out.push_back(entry);
    return out;
}

} // namespace

FrameStore::FrameStore(fs::path folder, std::uintmax_t budget, std::string_view build, FileAccess files)
    : folder_(std::move(folder))
    , budget_(budget)
    , build_(Hasher().add(build).finish())
    , files_(folder_, std::string(frames_ending), std::move(files))
    , written_(budget) {} // so that room is made before the first is written

FrameStore::Bytes FrameStore::start_of(const Digest& start) const {
    {
        const std::lock_guard lock(mutex_);
        if (const auto it = starts_.find(start); it != starts_.end()) return it->second;
    }
    std::string fault;
    Bytes bytes = whole(start, true, fault);
    if (!bytes) return nullptr;
    const std::lock_guard lock(mutex_);
    if (starts_.size() >= most_starts) starts_.clear();
    starts_[start] = bytes;
    return bytes;
}

FrameStore::Bytes FrameStore::whole(const Digest& key, bool is_start, std::string& fault) const {
    DiskStore::Found found = files_.read(key);
    fault = found.fault;
    if (!found.payload) return nullptr;
    try {
        ByteReader in(*found.payload);
        const auto start = in.get<Digest>();
        const auto size = in.get<std::uint64_t>();
        auto out = std::make_shared<LaidFrame>();
        out->first_block = in.get_list<std::uint32_t>();
        const auto& first = out->first_block;
        const bool in_order = std::is_sorted(first.begin(), first.end());
        if (!in_order || (!first.empty() && std::size_t{first.back()} * block > size))
            throw BadBytes("its parts lie beyond its end");
        const auto others = in.get_list<std::uint32_t>();
        if (start != key && is_start) throw BadBytes("the start frame differs from yet another frame");
        const Bytes base = start != key ? start_of(start) : nullptr;
        if (start != key && !base) throw BadBytes("the start frame that it differs from is gone");
        // What the start frame does not have is in blocks of its own; its last may be short.
        const std::size_t from_start = base ? base->bytes.size() + block : 0;
        if (size > from_start + others.size() * block) throw BadBytes("it is longer than its blocks");
        out->bytes.resize(size);
        for (std::size_t k = 0; base && k < first.size(); ++k) {
            const auto section = base->section(k);
            const std::size_t count = std::min(section.size(), out->section(k).size());
            std::copy_n(section.begin(), count, out->bytes.begin() + std::ptrdiff_t{first[k]} * std::ptrdiff_t{block});
        }
        for (const std::uint32_t b : others) {
            if (std::size_t{b} * block >= size) throw BadBytes("its blocks lie beyond its end");
            const std::size_t count = bytes_of(out->bytes, b);
            if (count > in.rest.size()) throw BadBytes("it ends too early");
            std::memcpy(out->bytes.data() + std::size_t{b} * block, in.rest.data(), count);
            in.rest = in.rest.subspan(count);
        }
        if (!in.rest.empty()) throw BadBytes("it holds more than its blocks");
        return out;
    } catch (const BadBytes& bad) {
        fault = bad.what();
        return nullptr;
    } catch (const std::bad_alloc&) {
        fault = "it says that it is larger than memory";
        return nullptr;
    }
}

FrameStore::Found FrameStore::read(const Registry& registry, const NodeType& type, const Digest& key,
                                   bool with_state) const {
    Found out;
    const Digest name = name_of(key);
    const Bytes bytes = whole(name, false, out.fault);
    if (!bytes) return out;
    try {
        out.frame = decode(registry, type, *bytes, with_state);
        files_.touch(name);
    } catch (const BadBytes& bad) {
        out.fault = bad.what();
    }
    return out;
}

void FrameStore::write(const Registry& registry, const NodeType& type, const Digest& frame_key, const Digest& start_key,
                       const KeptFrame& frame) {
    make_room();
    const Digest key = name_of(frame_key), start = name_of(start_key);
    std::shared_ptr<LaidFrame> laid;
    {
        const std::lock_guard lock(mutex_);
        laid.swap(room_);
    }
    if (!laid) laid = std::make_shared<LaidFrame>();
    encode(registry, type, frame, *laid);
    Bytes base;
    if (key != start) {
        base = start_of(start);
        files_.touch(start); // it is needed as long as the frames that differ from it
    }
    // Without the start frame's file it stands for itself.
    const std::vector<std::byte> payload = differing(*laid, base.get(), base ? start : key);
    files_.write(key, payload, false);
    const std::lock_guard lock(mutex_);
    written_ += payload.size();
    if (key == start) {
        if (starts_.size() >= most_starts) starts_.clear();
        laid->bytes.shrink_to_fit();
        starts_[start] = std::move(laid);
    } else if (laid->bytes.capacity() <= most_room) {
        room_ = std::move(laid);
    }
}

void FrameStore::read_rows(const std::function<void(const PlugContent&)>& take) const {
    std::vector<fs::directory_entry> files = files_in(folder_, rows_ending);
    std::erase_if(files, [&](const auto& file) { return !file.path().filename().string().starts_with(build_.hex()); });
    for (const fs::directory_entry& file : files) read_row_file(file.path(), take);
    if (files.size() < most_row_files) return;
    std::vector<PlugContent> all;
    std::vector<fs::path> done;
    for (const fs::directory_entry& file : files) {
        std::error_code error;
        const auto age = fs::file_time_type::clock::now() - file.last_write_time(error);
        if (error || age < std::chrono::hours(1)) continue; // its process may still write to it
        read_row_file(file.path(), [&](const PlugContent& row) { all.push_back(row); });
        done.push_back(file.path());
    }
    if (done.size() < 2) return;
    try {
        append_rows(done.front().string() + ".new", all);
        fs::rename(done.front().string() + ".new", done.front());
    } catch (const std::exception&) {
        return; // it is only tidier
    }
    std::error_code error;
    for (std::size_t i = 1; i < done.size(); ++i) fs::remove(done[i], error);
}

void FrameStore::add_rows(std::span<const PlugContent> rows) {
    if (rows.empty()) return;
    const std::lock_guard lock(mutex_);
    if (rows_.empty()) {
        std::error_code error;
        fs::create_directories(folder_, error);
        std::random_device dice;
        Hasher h;
        h.add(static_cast<std::uint64_t>(getpid())).add(std::uint64_t{dice()}).add(std::uint64_t{dice()});
        rows_ = folder_ / (build_.hex() + "-" + h.finish().hex() + std::string(rows_ending));
    }
    append_rows(rows_, rows);
}

std::vector<FrameStore::Listed> FrameStore::frames_of(const std::string& node) const {
    std::vector<Listed> out;
    for (const Digest& key : files_.newest_first()) {
        std::string fault;
        const Bytes bytes = whole(key, false, fault);
        if (!bytes) continue;
        try {
            KeptFrame frame;
            Digest type;
            read_made_from(Sections(*bytes).next(), frame, type);
            if (frame.made_from.node == node) out.push_back({std::move(frame.made_from), frame.frame});
        } catch (const BadBytes&) {
        }
    }
    return out;
}

void FrameStore::make_room() {
    {
        const std::lock_guard lock(mutex_);
        if (written_ < budget_ / 16) return;
        written_ = 0;
    }
    struct File {
        fs::file_time_type used;
        std::uintmax_t size;
        fs::path path;
    };
    std::vector<File> all;
    std::uintmax_t sum = 0;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder_, error)) {
        if (!is_ours(entry.path())) continue;
        std::error_code gone;
        const File file{entry.last_write_time(gone), entry.file_size(gone), entry.path()};
        if (gone) continue;
        sum += file.size;
        all.push_back(file);
    }
    std::sort(all.begin(), all.end(), [](const File& a, const File& b) { return a.used < b.used; });
    // A sixteenth of free room, which is what is written until this looks again.
    for (const File& file : all) {
        if (sum <= budget_ - budget_ / 16) break;
        if (file.path == rows_ || !fs::remove(file.path, error)) continue;
        sum -= file.size;
    }
}

namespace {

/// What one file is of it.
DiskUse use_of(const fs::path& file) {
    DiskUse out;
    out.files = 1;
    out.frames = file.extension() == frames_ending;
    out.outputs = file.extension() == outputs_ending;
    std::error_code gone;
    if (const auto size = fs::file_size(file, gone); !gone) out.bytes = size;
    return out;
}

void add_to(DiskUse& all, const DiskUse& one) {
    all.files += one.files, all.frames += one.frames, all.outputs += one.outputs, all.bytes += one.bytes;
}

} // namespace

DiskUse disk_use(const fs::path& folder) {
    DiskUse out;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (is_ours(entry.path())) add_to(out, use_of(entry.path()));
    return out;
}

Removal remove_kept(const fs::path& folder) {
    Removal out;
    const auto is_left = [&](const fs::path& what, const std::error_code& why) {
        if (out.why.empty()) out.first = what, out.why = why.message();
    };
    std::error_code error;
    std::vector<fs::path> ours;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (is_ours(entry.path())) ours.push_back(entry.path());
    if (error && error != std::errc::no_such_file_or_directory) is_left(folder, error);
    for (const fs::path& file : ours) {
        const DiskUse use = use_of(file);
        if (fs::remove(file, error)) {
            add_to(out.removed, use);
        } else if (error) { // else another process was quicker
            ++out.left;
            is_left(file, error);
        }
    }
    if (!ours.empty()) fs::remove(folder, error); // only if it is empty now
    return out;
}

} // namespace sinew::engine
