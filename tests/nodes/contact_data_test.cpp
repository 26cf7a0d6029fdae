// Contacts as zSolver gives them: what they hold, where they come from, and what switches them on.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "nodes/contacts.h"

using namespace bench;
using Catch::Detail::Approx;
using solver::ContactPoint;
using solver::Vec3;

namespace {

/// A cube of one metre and 1000 kg above the flat top of a bone at y = 0, `u` scene units a metre.
std::string falling(const std::string& solver, const std::string& block = "", const std::string& ground = "",
                    double gap = 0.01, double u = 1) {
    return R"("slab": {"type": "polyCube", "inputs": {"width": )" + number(6 * u) + R"(, "height": )" + number(u) +
           R"(, "depth": )" + number(6 * u) + R"(}},
        "slabPlace": {"type": "transform", "inputs": {"mesh": {"from": "slab.outMesh"}, "translate": [0, )" +
           number(-0.5 * u) + R"(, 0]}},
        "ground": {"type": "zBone", "inputs": {"mesh": {"from": "slabPlace.outMesh"})" +
           ground + R"(}},
        "cube": {"type": "polyCube", "inputs": {"width": )" +
           number(u) + R"(, "height": )" + number(u) + R"(, "depth": )" + number(u) +
           R"(, "subdivisionsWidth": 4, "subdivisionsHeight": 4, "subdivisionsDepth": 4}},
        "place": {"type": "transform", "inputs": {"mesh": {"from": "cube.outMesh"}, "translate": [0, )" +
           number((0.5 + gap) * u) + R"(, 0]}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "place.outMesh"}, "tetSize": )" +
           number(0.37 * u) + R"(}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e6, "massDensity": 1000}},
        "block": {"type": "zTissue", "inputs": {"mesh": {"from": "place.outMesh"}, "tets": {"from": "tets.outTets"},
            "materials": [{"from": "flesh.outMaterial"}])" +
           block + R"(}},
        "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "ground.outBody"}, {"from": "block.outBody"}],
            "scale": )" +
           number(u) + R"(, "maxNewtonIterations": 40, "stiffnessDamping": 0.01)" + solver + "}}";
}

const std::string on = R"(, "collisionDetection": true)";

nodes::ContactList contacts(Session& s, double frame) {
    return s.get<nodes::ContactList>("solver", "outContacts", frame);
}

Vec3 sum_of_forces(const nodes::ContactList& list) {
    Vec3 out = Vec3::Zero();
    for (const ContactPoint& c : list.contacts) out += c.force;
    return out;
}

solver::Points block_points(Session& s, double frame) {
    return *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[1].points;
}

double lowest(Session& s, double frame) {
    double out = std::numeric_limits<double>::infinity();
    for (const Vec3& p : block_points(s, frame)) out = std::min(out, p.y());
    return out;
}

double reported(Session& s, double frame, const char* measure) {
    return solver::value_of(s.get<nodes::SolveReport>("solver", "outReport", frame).record.measured, "contact",
                            measure);
}

} // namespace

TEST_CASE("contacts say who touches whom, where, how deep and how hard, in any scene unit", "[nodes][contact]") {
    for (const double u : {1.0, 100.0}) {
        CAPTURE(u);
        Session s(falling(on, "", "", 0.01, u));
        const nodes::ContactList list = contacts(s, 40);
        REQUIRE(list.contacts.size() >= 25); // the vertices of the lower side
        CHECK(static_cast<double>(list.contacts.size()) == reported(s, 40, "contacts"));
        double deepest = 0, pressed = 0;
        for (const ContactPoint& c : list.contacts) {
            CHECK(c.source == 1);
            CHECK(c.target == 0);
            CHECK(c.slides);
            CHECK((c.normal - Vec3(0, 1, 0)).norm() < 1e-9); // the ground's top
            CHECK(c.depth == Approx(-c.place.y() / u).epsilon(1e-9).margin(1e-12));
            CHECK(c.force.y() >= 0);
            deepest = std::max(deepest, c.depth), pressed += c.force.norm();
        }
        CHECK(deepest == Approx(reported(s, 40, "max_depth_m")).epsilon(1e-9));
        CHECK(pressed == Approx(reported(s, 40, "force_N")).epsilon(1e-9));
        const Vec3 force = sum_of_forces(list);
        CHECK(force.y() == Approx(9800).epsilon(0.002)); // what it weighs
        CHECK(Vec3(force.x(), 0, force.z()).norm() < 1e-6 * 9800);
        const nodes::WorstPlaces worst = s.get<nodes::SolveReport>("solver", "outReport", 40).worst;
        CHECK(worst.contact_body == 1);
        CHECK(worst.contact_target == 0);
        CHECK(worst.depth == deepest);
        CHECK(worst.contact_place[1] == Approx(-deepest * u).epsilon(1e-9));
        CHECK(s.counter.warnings.empty());
    }
}

TEST_CASE("a body that begins exactly on another presses with all of its points", "[nodes][contact]") {
    // Rounding puts some of them inside and some outside.
    for (const double degrees : {0.0, 20.0, 27.2, 28.0, 45.0}) {
        CAPTURE(degrees);
        const double turn = degrees * EIGEN_PI / 180, up = 0.5 * std::cos(turn), aside = 0.5 * std::sin(turn);
        const auto place = [&](double along) {
            return R"("translate": [)" + number(-along * aside) + ", " + number(along * up) +
                   R"(, 0], "rotate": [0, 0, )" + number(degrees) + "]";
        };
        std::string text = falling(on, "", "", 0);
        const auto replace = [&](const std::string& from, const std::string& to) {
            REQUIRE(text.find(from) != std::string::npos);
            text.replace(text.find(from), from.size(), to);
        };
        replace(R"("translate": [0, -0.5, 0])", place(-1));
        replace(R"("translate": [0, 0.5, 0])", place(1));
        Session s(text);
        std::size_t vertices = 0;
        for (const ContactPoint& c : contacts(s, 4).contacts) vertices += c.source == 1 && c.point < 98;
        CHECK(vertices == 25);
    }
}

TEST_CASE("friction and the hold of what does not slide are in a contact's force", "[nodes][contact]") {
    // Down and along x as on a slope of 1 : 4; friction of .5 holds it, and so does a fixed contact.
    const std::string slope = on + R"(, "gravity": [2.4, -9.6, 0])";
    for (const bool held : {false, true}) {
        CAPTURE(held);
        const std::string how = held ? R"(, "contactSliding": false)" : R"(, "contactFriction": 0.5)";
        Session s(falling(slope, how, how));
        const nodes::ContactList list = contacts(s, 60);
        REQUIRE_FALSE(list.contacts.empty());
        for (const ContactPoint& c : list.contacts) CHECK(c.slides != held);
        const Vec3 force = sum_of_forces(list);
        CHECK(force.x() == Approx(-2400).epsilon(0.01));
        CHECK(force.y() == Approx(9600).epsilon(0.01));
    }
}

TEST_CASE("contacts are those of the state, whether it was stepped to, loaded, or found again", "[nodes][contact]") {
    for (const std::string scheme : {"BackwardEuler", "BDF2", "TR-BDF2"}) {
        CAPTURE(scheme);
        const std::string text = falling(on + R"(, "integrator": ")" + scheme + "\"", R"(, "contactFriction": 0.3)",
                                         R"(, "contactFriction": 0.3)");
        Session s(text), other(text);
        const engine::Digest first = s.pull("solver", "outContacts", 12).digest();
        CHECK(first != s.pull("solver", "outContacts", 11).digest());
        s.evaluator.drop_values();
        CHECK(s.pull("solver", "outContacts", 12).digest() == first);
        const auto bytes = s.evaluator.save_state({s.graph, {"solver", "outMeshes"}, 12});
        other.evaluator.load_state({other.graph, {"solver", "outMeshes"}, 12}, bytes);
        CHECK(other.pull("solver", "outContacts", 12).digest() == first);
        CHECK(other.counter.steps["solver"] == 0);
        CHECK(other.pull("solver", "outContacts", 14).digest() == s.pull("solver", "outContacts", 14).digest());
    }
}

TEST_CASE("while collisionDetection is off no attribute of contact simulates anything again", "[nodes][contact]") {
    Session s(falling(""));
    s.pull("solver", "outMeshes", 6);
    const int steps = s.counter.steps["solver"];
    const std::vector<std::array<std::string, 3>> edits{
        {"block", "contactStiffness", "2e5"},       {"block", "collisions", "false"},
        {"block", "selfCollisions", "true"},        {"block", "contactFriction", "0.3"},
        {"ground", "contactSliding", "false"},      {"ground", "collisionVolume", "\"off\""},
        {"ground", "collisionSets", "\"0 3\""},     {"solver", "collisionSubdivision", "true"},
        {"solver", "collisionPointSpacing", "0.3"}, {"solver", "maxContactLength", "0.2"},
        {"solver", "contactDamping", "10"}};
    const auto unedited = s.graph;
    for (const auto& [node, attribute, json] : edits) {
        s.set(node, attribute, json);
        s.pull("solver", "outMeshes", 6);
    }
    CHECK(s.counter.steps["solver"] == steps);
    CHECK(s.get<nodes::SolveReport>("solver", "outReport", 6).terms ==
          std::vector<std::string>{"StVK", "compressionResistance", "gravity", "inertia", "damping"});
    // Switched on, each of them is another simulation.
    s.graph = unedited;
    s.set("solver", "collisionDetection", "true");
    s.pull("solver", "outMeshes", 2);
    for (const auto& [node, attribute, json] : edits) {
        CAPTURE(node, attribute);
        const int before = s.counter.steps["solver"];
        const auto graph = s.graph;
        s.set(node, attribute, json);
        s.pull("solver", "outMeshes", 2);
        CHECK(s.counter.steps["solver"] == before + 2);
        s.graph = graph;
    }
}

TEST_CASE("contact that is keyed on is there from that frame, and costs nothing before", "[nodes][contact]") {
    for (const std::string more : {R"(, "integrator": "BackwardEuler")", R"(, "integrator": "BDF2", "substeps": 2)",
                                   R"(, "integrator": "TR-BDF2")"}) {
        CAPTURE(more);
        const auto keyed = [&](const std::string& keys) {
            return falling(R"(, "collisionDetection": {"keys": )" + keys + "}" + more, "", "", 0.2);
        };
        Session off(falling(more, "", "", 0.2)), always(falling(on + more, "", "", 0.2)),
            s(keyed("[[1, false], [4, true]]"));
        // It is still in the air at frame 4, so that what comes later is as if contact had always been there.
        CHECK(block_points(s, 3) == block_points(off, 3));
        CHECK(contacts(s, 3).contacts.empty());
        const auto has_contact = [&](double frame) {
            const auto terms = s.get<nodes::SolveReport>("solver", "outReport", frame).terms;
            return std::find(terms.begin(), terms.end(), "contact") != terms.end();
        };
        CHECK_FALSE(has_contact(3));
        CHECK(has_contact(4));
        CHECK(block_points(s, 12) == block_points(always, 12));
        const auto most_contacts = [&](int first, int last) { // it bounces
            std::size_t most = 0;
            for (int f = first; f <= last; ++f) most = std::max(most, contacts(s, f).contacts.size());
            return most;
        };
        CHECK(most_contacts(4, 12) >= 25);
        CHECK(lowest(off, 12) < lowest(s, 12) - 0.1);

        // Loaded before the switch, it goes on to the same bits.
        Session loaded(keyed("[[1, false], [4, true]]"));
        const auto bytes = s.evaluator.save_state({s.graph, {"solver", "outMeshes"}, 3});
        loaded.evaluator.load_state({loaded.graph, {"solver", "outMeshes"}, 3}, bytes);
        CHECK(block_points(loaded, 12) == block_points(s, 12));
        CHECK(loaded.counter.steps["solver"] == 9);

        // Switched off at frame 10, frames 10 to 12 are simulated again, and it falls through.
        const int before = s.counter.steps["solver"];
        s.set("solver", "collisionDetection", R"({"keys": [[1, false], [4, true], [10, false]]})");
        s.pull("solver", "outMeshes", 12);
        CHECK(s.counter.steps["solver"] == before + 3);
        CHECK(most_contacts(4, 9) >= 25);
        CHECK(contacts(s, 10).contacts.empty());
        CHECK_FALSE(has_contact(10));
        CHECK(lowest(s, 20) < -0.2);
        CHECK(lowest(always, 20) > -0.1);
        CHECK(s.counter.warnings.empty());
    }
}

TEST_CASE("what is inside of another body where contact is keyed on is pushed out there", "[nodes][contact]") {
    // A tenth of a metre deep in the ground and without weight: it stays until it is pushed.
    const std::string still = R"(, "gravity": [0, 0, 0], "substeps": 2)";
    Session s(falling(still + R"(, "collisionDetection": {"keys": [[1, false], [5, true]]})", "", "", -0.1));
    CHECK(lowest(s, 4) == Approx(-0.1));
    const nodes::ContactList list = contacts(s, 5);
    CHECK(list.contacts.size() >= 25);
    for (const ContactPoint& c : list.contacts) CHECK((c.normal - Vec3(0, 1, 0)).norm() < 1e-9);
    CHECK(lowest(s, 30) > -0.002);
    // As it would have been from the start, four frames later.
    Session sooner(falling(still + on, "", "", -0.1));
    CHECK(lowest(s, 12) == Approx(lowest(sooner, 9)).margin(1e-6));
}

namespace {

std::string warned(Session& s, double frame) {
    s.pull("solver", "outMeshes", frame);
    std::string out;
    for (const engine::Diagnostic& d : s.counter.warnings) out += d.code + " " + d.message + "\n";
    return out;
}

} // namespace

TEST_CASE("a set that leaves a body alone is warned of where contact begins", "[nodes][contact]") {
    const std::string alone = R"(, "collisionSets": "7 8")";
    Session one(falling(on, alone));
    const std::string text = warned(one, 1);
    CHECK(text.find("FE256 block.collisionSets is \"7 8\"") != std::string::npos);
    CHECK(text.find("FE256 ground.collisionSets is \"0\"") != std::string::npos); // nobody is left for it either
    Session off(falling("", alone)), empty(falling(on, alone, R"(, "collisionSets": "")")),
        shared(falling(on, alone, R"(, "collisionSets": "8")")), out(falling(on, alone + R"(, "collisions": false)")),
        itself(falling(on, alone + R"(, "selfCollisions": true)", R"(, "collisionSets": "")"));
    for (Session* s : {&off, &empty, &shared, &itself}) CHECK(warned(*s, 2) == "");
    CHECK(warned(out, 1).find("block") == std::string::npos);
    Session later(falling(R"(, "collisionDetection": {"keys": [[1, false], [3, true]]})", alone));
    CHECK(warned(later, 2) == "");
    CHECK(warned(later, 3).find("FE256 block.collisionSets") != std::string::npos);
}

TEST_CASE("bodies that have nothing to push with are warned of where contact begins", "[nodes][contact]") {
    const std::string open = R"(, "collisionVolume": "off")";
    Session both(falling(on, open, open));
    const std::string nothing = " touches nothing: neither it nor any body that it could meet bounds a volume or has a "
                                "thickness\n";
    CHECK(warned(both, 1) == "FE256 ground" + nothing + "FE256 block" + nothing);
    Session block(falling(on, open)), ground(falling(on, "", open)), off(falling("", open, open)),
        alone(falling(on, open + R"(, "collisions": false)", open));
    for (Session* s : {&block, &ground, &off, &alone}) CHECK(warned(*s, 1) == "");
}

TEST_CASE("contact is as stiff and as rough as solves can bear", "[nodes][contact]") {
    const auto run = [](const std::string& value) {
        return codes([&] {
            Session s(falling(on, value, value));
            CHECK(warned(s, 5).empty()); // an unconverged step would be one
        });
    };
    using Codes = std::vector<std::string>;
    CHECK(run(R"(, "contactStiffness": 1e12, "contactFriction": 1e6)").empty());
    CHECK(run(R"(, "contactStiffness": 1.1e12)") == Codes{"DG013", "DG013"});
    CHECK(run(R"(, "contactFriction": 1.1e6)") == Codes{"DG013", "DG013"});
}

TEST_CASE("too many points for a spacing are refused at the spacing", "[nodes][contact]") {
    Session s(falling(on + R"(, "collisionSubdivision": true, "collisionPointSpacing": 1e-4)"));
    try {
        s.pull("solver", "outMeshes", 1);
        FAIL("it was taken");
    } catch (const engine::Failure& f) {
        const engine::Diagnostic& d = f.diagnostics().front();
        CHECK(d.code == "FE232");
        CHECK(d.node == "solver");
        CHECK(d.attribute == "collisionPointSpacing");
        CHECK(d.message.find("ground") != std::string::npos);
    }
}

TEST_CASE("a writer makes tables of contacts", "[nodes][contact]") {
    const std::string writers =
        R"(, "csv": {"type": "contactWriter", "inputs": {"contacts": {"from": "solver.outContacts"}}},
        "json": {"type": "contactWriter", "inputs": {"contacts": {"from": "solver.outContacts"}, "format": "json"}})";
    Session s(falling(on) + writers);
    const nodes::ContactList list = contacts(s, 10);
    REQUIRE_FALSE(list.contacts.empty());
    const auto csv = s.get<nodes::FileContent>("csv", "outFile", 10);
    CHECK(csv.ending == "csv");
    std::istringstream lines(csv.bytes);
    std::string line;
    std::getline(lines, line);
    CHECK(line == "source,target,point,sliding,x,y,z,normal_x,normal_y,normal_z,depth_m,force_x_N,force_y_N,force_z_N");
    for (const ContactPoint& c : list.contacts) {
        REQUIRE(std::getline(lines, line));
        std::string start = "1,0," + std::to_string(c.point) + ",true,";
        REQUIRE(line.substr(0, start.size()) == start);
        std::istringstream numbers(line.substr(start.size()));
        std::vector<double> found;
        for (std::string word; std::getline(numbers, word, ',');) found.push_back(std::stod(word));
        CHECK(found == std::vector<double>{c.place.x(), c.place.y(), c.place.z(), c.normal.x(), c.normal.y(),
                                           c.normal.z(), c.depth, c.force.x(), c.force.y(), c.force.z()});
    }
    CHECK_FALSE(std::getline(lines, line));
    CHECK(s.get<nodes::FileContent>("json", "outFile", 1).bytes == "{\"contacts\": []}\n");
    CHECK(s.get<nodes::FileContent>("csv", "outFile", 1).bytes.find('\n') + 1 ==
          s.get<nodes::FileContent>("csv", "outFile", 1).bytes.size());
    const std::string json = s.get<nodes::FileContent>("json", "outFile", 10).bytes;
    CHECK(json.find("{\"source\": 1, \"target\": 0, \"point\": ") != std::string::npos);
    CHECK(static_cast<std::size_t>(std::count(json.begin(), json.end(), '\n')) == list.contacts.size() + 2);
}
