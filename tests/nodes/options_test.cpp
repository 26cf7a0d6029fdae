// Words of attributes: every value has one word, and every word leads back to its value.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/options.h"

#include <catch2/catch.hpp>

using namespace sinew;
using namespace sinew::nodes;

namespace {

template <class E>
void check_words(std::size_t count) {
    REQUIRE(options_of<E>.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
        const E value = static_cast<E>(i);
        CHECK(meaning(options_of<E>, word_of(value)) == value); // false too if two values share a word
    }
    CHECK_THROWS_AS(meaning(options_of<E>, "no such word"), std::logic_error);
    CHECK_THROWS_AS(meaning(options_of<E>, ""), std::logic_error);
}

} // namespace

TEST_CASE("each choice of the solver has a word of its own, and the word means that choice") {
    check_words<solver::ElasticLaw>(std::size(solver::elastic_laws));
    check_words<solver::ElementKind>(2);
    check_words<solver::Fill>(3);
    check_words<solver::AttachmentMode>(3);
    check_words<solver::Correspondence>(2);
    check_words<solver::Integrator>(4);
    check_words<solver::LinearMethod>(4);
}

TEST_CASE("words in files keep their meaning") {
    CHECK(meaning(options_of<solver::ElasticLaw>, "NeoHookean") == solver::ElasticLaw::neo_hookean);
    CHECK(meaning(options_of<solver::ElasticLaw>, "LogNeoHookean") == solver::ElasticLaw::log_neo_hookean);
    CHECK(meaning(options_of<solver::Integrator>, "TR-BDF2") == solver::Integrator::tr_bdf2);
    CHECK(meaning(options_of<solver::LinearMethod>, "Plain") == solver::LinearMethod::plain);
    CHECK(meaning(options_of<solver::Fill>, "EmptyCavities") == solver::Fill::empty_cavities);
    CHECK(meaning(options_of<solver::ElementKind>, "quadratic") == solver::ElementKind::quadratic);
    CHECK(meaning(options_of<solver::Correspondence>, "worldSpace") == solver::Correspondence::closest_point);
    CHECK(meaning(options_of<solver::AttachmentMode>, "none") == solver::AttachmentMode::none);
}
