// The command line parser: what it takes, and what it says about everything else.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"

#include <catch2/catch.hpp>

using namespace sinew::cli;

namespace {

const Command sample{"sample",
                     "does something",
                     {{"GRAPH", "the graph"}, {"PLUG", "a plug", false}},
                     {{"--frames", "A-B", "which frames"},
                      {"--set", "NODE.ATTR=JSON", "a value", true},
                      {"--out", "DIR", "where", false, 'o'},
                      {"--json", "", "as JSON"}},
                     "sinew sample a.json",
                     nullptr};

Arguments parse(std::vector<std::string> words) { return Arguments(sample, words); }

std::string message_of(std::vector<std::string> words) {
    try {
        parse(std::move(words));
    } catch (const UsageError& e) {
        return e.what();
    }
    return "no error";
}

std::string frames_error(const std::string& text) {
    try {
        parse_frames(text);
    } catch (const UsageError& e) {
        return e.what();
    }
    return "no error";
}

} // namespace

TEST_CASE("flags take their value after a space, after an equals sign or after their letter", "[tools]") {
    const Arguments a = parse({"--frames", "1-3", "g.json", "--out=x", "--json"});
    CHECK(a.value("--frames") == "1-3");
    CHECK(a.value("--out") == "x");
    CHECK(a.has("--json"));
    CHECK(a.operand(0) == "g.json");
    CHECK_FALSE(a.operand(1));
    CHECK(parse({"g.json", "-o", "y"}).value("--out") == "y");
    CHECK(parse({"g.json", "--set", "a.b=1", "--set=c.d={\"x\": \"=\"}"}).values("--set") ==
          std::vector<std::string>{"a.b=1", "c.d={\"x\": \"=\"}"});
}

TEST_CASE("after -- everything is an operand, and a lone dash is one too", "[tools]") {
    CHECK(parse({"--", "--frames"}).operand(0) == "--frames");
    CHECK(parse({"-"}).operand(0) == "-");
}

TEST_CASE("a negative number is a value, not a flag", "[tools]") {
    CHECK(parse({"g", "--frames", "-5"}).value("--frames") == "-5");
}

TEST_CASE("every mistake on the command line is named, with the nearest flag", "[tools]") {
    CHECK(message_of({"g", "--frame", "1"}) == "unknown flag '--frame'. Did you mean '--frames'?");
    CHECK(message_of({"g", "--zzzzzz"}) == "unknown flag '--zzzzzz'.");
    CHECK(message_of({"g", "--frames"}) == "--frames needs a value: A-B.");
    CHECK(message_of({"g", "--frames", "--json"}) ==
          "--frames needs a value: A-B. '--json' looks like a flag; if it is meant, write --frames=--json.");
    CHECK(parse({"g", "--frames=--json"}).value("--frames") == "--json");
    CHECK(message_of({"g", "--json=yes"}) == "--json takes no value.");
    CHECK(message_of({"g", "--frames", "1", "--frames", "2"}) == "--frames is given twice.");
    CHECK(message_of({}) == "GRAPH is missing.");
    CHECK(message_of({"a", "b", "c"}) == "unexpected word 'c'.");
}

TEST_CASE("help is given even if the rest of the line is incomplete", "[tools]") {
    CHECK(parse({"--help"}).wants_help());
}

TEST_CASE("whole numbers are checked", "[tools]") {
    CHECK(parse({"g", "--frames", "12"}).whole_number("--frames", 0, 1) == 12);
    CHECK(parse({"g"}).whole_number("--frames", 7, 1) == 7);
    for (const char* text : {"0", "1.5", "", "x", "1x", "99999999999"})
        CHECK_THROWS_AS(parse({"g", "--frames", text}).whole_number("--frames", 0, 1), UsageError);
    const auto up_to_nine = [](const char* text) {
        try {
            return std::to_string(parse({"g", "--frames", text}).whole_number("--frames", 0, 1, 9));
        } catch (const UsageError& e) {
            return std::string(e.what());
        }
    };
    CHECK(up_to_nine("9") == "9");
    CHECK(up_to_nine("10") == "--frames needs a whole number from 1 to 9, not '10'.");
}

TEST_CASE("lists of frames have ranges, single frames and negative ones, each once", "[tools]") {
    CHECK(parse_frames("7") == std::vector{7});
    CHECK(parse_frames("1-4") == std::vector{1, 2, 3, 4});
    CHECK(parse_frames("1,64,128") == std::vector{1, 64, 128});
    CHECK(parse_frames("2-4,3-5,1") == std::vector{2, 3, 4, 5, 1});
    CHECK(parse_frames("-2-1") == std::vector{-2, -1, 0, 1});
    CHECK(parse_frames("-3--2") == std::vector{-3, -2});
    for (const char* text : {"", "a", "1-", "-", "1,,2", "4-1", "1.5", "1-2-3"}) {
        INFO(text);
        CHECK(frames_error(text) != "no error");
    }
    CHECK(frames_error("1-2000000") == "'1-2000000' is more than a million frames.");
}

TEST_CASE("every command explains itself with its flags and an example", "[tools]") {
    for (const Command& command : all_commands()) {
        INFO(command.name);
        const std::string help = help_text(command);
        CHECK_FALSE(command.summary.empty());
        CHECK(help.find("Usage: sinew " + std::string(command.name)) != std::string::npos);
        CHECK(command.example.starts_with("sinew " + std::string(command.name)));
        for (const Flag& flag : command.flags) {
            CHECK(help.find(flag.name) != std::string::npos);
            CHECK_FALSE(flag.doc.empty());
        }
    }
}

TEST_CASE("the examples in the help are command lines that the parser takes", "[tools]") {
    for (const Command& command : all_commands()) {
        INFO(command.name);
        const std::string first = split(command.example, '\n').front();
        std::vector<std::string> words = split(split(first, '|').front(), ' ');
        std::erase(words, "");
        CHECK_NOTHROW(Arguments(command, std::span(words).subspan(2)));
    }
}

TEST_CASE("only a last operand that repeats takes any number of words", "[tools]") {
    Command many = sample;
    many.operands = {{"NAME", "what"}, {"FILES", "on what", false, true}};
    const std::vector<std::string> words{"a", "b", "--json", "c", "d"};
    const Arguments arguments(many, words);
    CHECK(arguments.operands_from(1) == std::vector<std::string>{"b", "c", "d"});
    CHECK(arguments.operands_from(4).empty());
    CHECK(usage_line(many).find("NAME [FILES]… ") != std::string::npos);
    CHECK(parse({"a", "b"}).operands_from(1) == std::vector<std::string>{"b"});
    CHECK_THROWS_AS(Arguments(sample, words), UsageError);
}
