// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/frame_store.h"

#include "engine/atomic_file.h"
#include "engine/eval/cache_folder.h"
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
constexpr std::size_t most_sweeps = 64;
/// Of a frame whose memory the next one takes over [bytes].
constexpr std::size_t most_room = std::size_t{64} << 20;
constexpr std::string_view rows_mark = "sinew rows 2\n";
/// From so many files of rows on one is made of those that nobody writes to any more.
constexpr std::size_t most_row_files = 32;
/// Rows of this build stay where room is made as long as they are no more [bytes], and no more than their share.
constexpr std::uintmax_t most_spared_rows = std::uintmax_t{64} << 20;
/// Of the budget: what is written until room is made again, and what rows may take of it.
constexpr std::uintmax_t share = 16;

} // namespace

/// Sections begin at a block's edge, and each is told from the same one of the start frame: one that changes its length
/// moves none of the others.
struct LaidPart {
    std::vector<std::byte> bytes;
    std::vector<std::uint32_t> first_block; ///< of each section

    void clear() { bytes.clear(), first_block.clear(); }
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

struct LaidFrame {
    LaidPart told; ///< what it was made from, its outputs, its warnings
    std::optional<LaidPart> state;
    std::vector<std::byte> file; ///< room for what was last read
    std::size_t capacity() const {
        return told.bytes.capacity() + file.capacity() + (state ? state->bytes.capacity() : 0);
    }
};

namespace {

class Sections {
  public:
    explicit Sections(const LaidPart& of)
        : of_(of) {}
    std::span<const std::byte> next() {
        ByteReader in(of_.section(next_++));
        const auto size = in.get<std::uint64_t>();
        if (size > in.rest.size()) throw BadBytes("it ends too early");
        return in.rest.first(size);
    }

  private:
    const LaidPart& of_;
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

void encode(const Registry& registry, const NodeType& type, const KeptFrame& frame, LaidFrame& out) {
    out.told.clear();
    out.told.put([&](ByteWriter& made_from) {
        made_from.put(identity(type).finish());
        made_from.put<std::int64_t>(frame.frame);
        made_from.put_text(frame.made_from.node);
        made_from.put<std::uint64_t>(frame.made_from.contents.size());
        for (const auto& [plug, content] : frame.made_from.contents) made_from.put_text(plug), made_from.put(content);
    });
    for (std::size_t i = 0; i < type.outputs.size(); ++i)
        out.told.put([&](ByteWriter& output) {
            const Codec* codec = registry.find_codec(type.outputs[i].type);
            output.put<std::uint8_t>(codec != nullptr);
            output.put(frame.entry->digest(i));
            if (!codec) return;
            output.put_text(codec->type_name);
            output.put<std::int64_t>(codec->version);
            codec->write(frame.entry->outputs[i], output);
        });
    out.told.put([&](ByteWriter& warnings) {
        put_warnings(warnings, frame.entry->warnings);
        put_warnings(warnings, frame.warnings_of_state);
    });
    if (!out.state) out.state.emplace();
    out.state->clear();
    out.state->put(
        [&](ByteWriter& state) { state.bytes.insert(state.bytes.end(), frame.state.begin(), frame.state.end()); });
}

FrameStore::Listed read_made_from(std::span<const std::byte> bytes) {
    FrameStore::Listed out;
    ByteReader in(bytes);
    out.made_by = in.get<Digest>();
    out.frame = static_cast<int>(in.get<std::int64_t>());
    out.made_from.node = in.get_text();
    const auto count = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
        std::string plug = in.get_text();
        out.made_from.contents.emplace_back(std::move(plug), in.get<Digest>());
    }
    return out;
}

/// \param like outputs of another frame, of which what is equal is shared; or nothing
KeptFrame decode(const Registry& registry, const NodeType& type, const LaidFrame& frame,
                 const std::vector<Value>& like) {
    KeptFrame out;
    Sections sections(frame.told);
    ByteReader made(sections.next());
    const auto made_by = made.get<Digest>();
    out.frame = static_cast<int>(made.get<std::int64_t>());
    if (made_by != identity(type).finish()) throw BadBytes("it was made by another version of the program");
    Entry entry;
    bool whole = true;
    for (std::size_t i = 0; i < type.outputs.size(); ++i) {
        ByteReader in(sections.next());
        const bool there = in.get<std::uint8_t>() != 0;
        const auto digest = in.get<Digest>();
        entry.known.push_back(digest);
        const Codec* codec = registry.find_codec(type.outputs[i].type);
        Value value;
        if (there && codec && in.get_text() == codec->type_name && in.get<std::int64_t>() == codec->version) {
            value = codec->read(in, i < like.size() && like[i] ? &like[i] : nullptr);
            if (value.digest() != digest) throw BadBytes("what it gives is not what was kept");
        }
        whole = whole && value;
        entry.outputs.push_back(std::move(value));
    }
    ByteReader in(sections.next());
    entry.warnings = get_warnings(in);
    out.warnings_of_state = get_warnings(in);
    if (whole) entry.known.clear();
    out.entry = std::make_shared<const Entry>(std::move(entry));
    if (!frame.state) return out;
    const std::span<const std::byte> state = Sections(*frame.state).next();
    out.state.assign(state.begin(), state.end());
    return out;
}

/// How many bytes of a section's block b there are; it is cut at the section's end.
std::size_t bytes_of(std::span<const std::byte> section, std::size_t b) {
    return std::min(block, section.size() - b * block);
}

/// Appends the blocks that are not those of the start frame at the same place of the same section.
void put_differing(ByteWriter& out, const LaidPart& part, const LaidPart* start) {
    out.put<std::uint64_t>(part.bytes.size());
    out.put_list(part.first_block);
    std::vector<std::uint32_t> others;
    for (std::size_t k = 0; k < part.first_block.size(); ++k) {
        const auto section = part.section(k), base = start ? start->section(k) : std::span<const std::byte>();
        for (std::size_t b = 0; b * block < section.size(); ++b) {
            const std::size_t count = bytes_of(section, b);
            const bool same = b * block + count <= base.size() &&
                              std::memcmp(section.data() + b * block, base.data() + b * block, count) == 0;
            if (!same) others.push_back(part.first_block[k] + static_cast<std::uint32_t>(b));
        }
    }
    out.put_list(others);
    out.bytes.reserve(out.bytes.size() + others.size() * block);
    for (const std::uint32_t b : others) {
        const auto bytes = std::span(part.bytes).subspan(std::size_t{b} * block, bytes_of(part.bytes, b));
        out.bytes.insert(out.bytes.end(), bytes.begin(), bytes.end());
    }
}

/// The part again, from what `put_differing` wrote. Throws BadBytes.
void get_differing(ByteReader in, const LaidPart* start, LaidPart& out) {
    const auto size = in.get<std::uint64_t>();
    out.first_block = in.get_list<std::uint32_t>();
    const auto& first = out.first_block;
    const bool in_order = std::is_sorted(first.begin(), first.end());
    if (!in_order || (!first.empty() && std::size_t{first.back()} * block > size))
        throw BadBytes("its parts lie beyond its end");
    const auto others = in.get_list<std::uint32_t>();
    // What the start frame does not have is in blocks of its own; its last may be short.
    const std::size_t from_start = start ? start->bytes.size() + block : 0;
    if (size > from_start + others.size() * block) throw BadBytes("it is longer than its blocks");
    out.bytes.resize(size); // of its last frame nothing may stay
    if (first.empty() || first.front() > 0) std::fill(out.bytes.begin(), out.bytes.end(), std::byte{0});
    for (std::size_t k = 0; k < first.size(); ++k) {
        const auto section = start ? start->section(k) : std::span<const std::byte>();
        const std::size_t all = out.section(k).size(), count = std::min(section.size(), all);
        const auto at = out.bytes.begin() + std::ptrdiff_t{first[k]} * std::ptrdiff_t{block};
        std::copy_n(section.begin(), count, at);
        std::fill_n(at + static_cast<std::ptrdiff_t>(count), all - count, std::byte{0});
    }
    for (const std::uint32_t b : others) {
        if (std::size_t{b} * block >= size) throw BadBytes("its blocks lie beyond its end");
        const std::size_t count = bytes_of(out.bytes, b);
        if (count > in.rest.size()) throw BadBytes("it ends too early");
        std::memcpy(out.bytes.data() + std::size_t{b} * block, in.rest.data(), count);
        in.rest = in.rest.subspan(count);
    }
    if (!in.rest.empty()) throw BadBytes("it holds more than its blocks");
}

/// A record of a file of rows.
std::string record_of(std::span<const PlugContent> rows) {
    ByteWriter out;
    out.put<std::uint64_t>(rows.size());
    for (const PlugContent& row : rows) out.put(row.plug), out.put(row.content);
    out.put(Hasher().add_bytes(out.bytes).finish());
    return {reinterpret_cast<const char*>(out.bytes.data()), out.bytes.size()};
}

void append_rows(const fs::path& file, std::span<const PlugContent> rows) {
    const int descriptor = open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor < 0) fail_to_write(file, std::strerror(errno));
    std::string text(lseek(descriptor, 0, SEEK_END) == 0 ? rows_mark : "");
    text += record_of(rows);
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    const std::string reason = written < 0 ? std::strerror(errno) : "there is no room for all of it";
    close(descriptor);
    if (written != static_cast<ssize_t>(text.size())) fail_to_write(file, reason);
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

std::shared_ptr<LaidFrame> FrameStore::take_room() const {
    std::shared_ptr<LaidFrame> room;
    {
        const std::lock_guard lock(mutex_);
        room.swap(room_);
    }
    return room ? room : std::make_shared<LaidFrame>();
}

void FrameStore::give_back(std::shared_ptr<LaidFrame> room) const {
    if (room->capacity() > most_room) return;
    const std::lock_guard lock(mutex_);
    room_ = std::move(room);
}

FrameStore::Bytes FrameStore::start_of(const Digest& start, bool with_state) const {
    {
        const std::lock_guard lock(mutex_);
        if (const auto it = starts_.find(start); it != starts_.end() && (it->second->state || !with_state))
            return it->second;
    }
    Bytes bytes = whole(start, true, with_state).bytes;
    if (!bytes) return nullptr;
    const std::lock_guard lock(mutex_);
    if (starts_.size() >= most_starts) starts_.clear();
    starts_[start] = bytes;
    return bytes;
}

FrameStore::Whole FrameStore::whole(const Digest& key, bool is_start, bool with_state) const {
    Whole out;
    const std::shared_ptr<LaidFrame> laid = is_start ? std::make_shared<LaidFrame>() : take_room();
    DiskStore::Found found = files_.read(key, with_state, std::move(laid->file));
    out.fault = std::move(found.fault);
    if (!found.payload) return out;
    try {
        ByteReader told(*found.payload);
        out.start = told.get<Digest>();
        const bool differs = out.start != key;
        if (differs && is_start) throw BadBytes("the start frame differs from yet another frame");
        const Bytes base = differs ? start_of(out.start, with_state) : nullptr;
        if (differs && !base) throw BadBytes("the start frame that it differs from is gone");
        get_differing(told, base ? &base->told : nullptr, laid->told);
        if (!with_state) laid->state.reset();
        if (with_state && !laid->state) laid->state.emplace();
        if (with_state) get_differing(ByteReader(found.tail), base ? &*base->state : nullptr, *laid->state);
        if (!is_start) laid->file = std::move(*found.payload);
        out.bytes = laid;
    } catch (const BadBytes& bad) {
        out.fault = bad.what();
    } catch (const std::bad_alloc&) {
        out.fault = "it says that it is larger than memory";
    }
    return out;
}

std::vector<Value> FrameStore::last_outputs(const Digest& start) const {
    const std::lock_guard lock(mutex_);
    const auto it = outputs_.find(start);
    return it == outputs_.end() ? std::vector<Value>() : it->second;
}

FrameStore::Found FrameStore::read(const Registry& registry, const NodeType& type, const Digest& key,
                                   bool with_state) const {
    Found out;
    const Digest name = name_of(key);
    Whole kept = whole(name, false, with_state);
    out.fault = std::move(kept.fault);
    if (!kept.bytes) return out;
    try {
        out.frame = decode(registry, type, *kept.bytes, last_outputs(kept.start));
        files_.touch(name, note_use(kept.start, out.frame->frame));
        if (kept.start != name) files_.touch(kept.start);
    } catch (const std::exception& bad) { // BadBytes, or what a codec of a host throws
        out.fault = bad.what();
    }
    give_back(std::move(kept.bytes));
    if (!out.frame) return out;
    const std::lock_guard lock(mutex_);
    if (outputs_.size() >= most_starts) outputs_.clear();
    outputs_[kept.start] = out.frame->entry->outputs;
    return out;
}

void FrameStore::write(const Registry& registry, const NodeType& type, const Digest& frame_key, const Digest& start_key,
                       const KeptFrame& frame) {
    const Digest key = name_of(frame_key), start = name_of(start_key);
    std::shared_ptr<LaidFrame> laid = take_room();
    encode(registry, type, frame, *laid);
    Bytes base;
    if (key != start && files_.contains(start)) { // else it went, to make room
        base = start_of(start, true);
        files_.touch(start); // it is needed as long as the frames that differ from it
    }
    ByteWriter told, state;
    told.put(base ? start : key); // without the start frame's file it stands for itself
    put_differing(told, laid->told, base ? &base->told : nullptr);
    put_differing(state, *laid->state, base ? &*base->state : nullptr);
    if (!make_room(DiskStore::file_size(told.bytes.size(), state.bytes.size()),
                   base ? std::optional(start) : std::nullopt)) {
        give_back(std::move(laid));
        return;
    }
    files_.write(key, told.bytes, false, state.bytes);
    files_.touch(key, note_use(start, frame.frame));
    if (key != start) give_back(std::move(laid));
    if (key != start) return;
    const std::lock_guard lock(mutex_);
    if (starts_.size() >= most_starts) starts_.clear();
    laid->told.bytes.shrink_to_fit(), laid->state->bytes.shrink_to_fit();
    laid->file = {};
    starts_[start] = std::move(laid);
}

std::vector<fs::directory_entry> FrameStore::rows_of_build() const {
    std::vector<fs::directory_entry> files = files_in(folder_, rows_ending);
    std::erase_if(files, [&](const auto& file) { return !file.path().filename().string().starts_with(build_.hex()); });
    return files;
}

void FrameStore::read_rows(const std::function<void(const PlugContent&)>& take) const {
    const std::vector<fs::directory_entry> files = rows_of_build();
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
        write_file_soon(done.front(), std::string(rows_mark) + record_of(all));
    } catch (const Failure&) {
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
        if (error) fail_to_write(folder_, error.message());
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
        Whole kept = whole(key, false, false);
        if (!kept.bytes) continue;
        try {
            Listed frame = read_made_from(Sections(kept.bytes->told).next());
            if (frame.made_from.node == node) out.push_back(std::move(frame));
        } catch (const BadBytes&) {
        }
        give_back(std::move(kept.bytes));
    }
    return out;
}

fs::file_time_type FrameStore::note_use(const Digest& start, int frame) const {
    const auto now = fs::file_time_type::clock::now();
    const std::lock_guard lock(mutex_);
    if (!sweeps_.contains(start) && sweeps_.size() >= most_sweeps) sweeps_.clear();
    const auto [it, is_new] = sweeps_.try_emplace(start);
    Sweep& sweep = it->second;
    if (is_new || frame < sweep.frame) sweep.first = frame, sweep.begun = now;
    sweep.frame = frame;
    return sweep.begun - (frame - sweep.first) * std::chrono::microseconds(10);
}

bool FrameStore::make_room(std::uintmax_t bytes, const std::optional<Digest>& needed) {
    std::uintmax_t together = bytes;
    std::set<fs::path> spared;
    if (needed) {
        const fs::path& start = *spared.insert(files_.file_of(*needed)).first;
        std::error_code gone;
        if (const auto size = fs::file_size(start, gone); !gone) together += size;
    }
    if (together > budget_) return false;
    {
        const std::lock_guard lock(mutex_);
        written_ += bytes;
        if (written_ <= budget_ / share) return true;
        written_ = bytes;
        spared.insert(rows_);
    }
    std::uintmax_t rows = 0;
    std::set<fs::path> row_files;
    for (const fs::directory_entry& file : rows_of_build()) {
        std::error_code gone;
        if (const auto size = file.file_size(gone); !gone) rows += size, row_files.insert(file.path());
    }
    if (rows <= std::min(budget_ / share, most_spared_rows)) spared.merge(row_files);
    engine::make_room(folder_, budget_ - std::max(bytes, budget_ / share), spared);
    return true;
}

} // namespace sinew::engine
