// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/fading_mean.h"

#include <catch2/catch.hpp>

using Catch::Detail::Approx;
using sinew::solver::FadingMean;

TEST_CASE("fading mean: each older value counts half, what rises is taken as it is") {
    FadingMean mean;
    CHECK(mean.take(4) == 4);
    CHECK(mean.take(1) == Approx((0.5 * 4 + 1) / 1.5));
    CHECK(mean.take(1) == Approx((0.25 * 4 + 0.5 * 1 + 1) / 1.75));
    CHECK(mean.take(9) == 9); // the mean of now is lower
    mean.raise(10);
    CHECK(mean.take(11) == Approx((0.0625 * 14 + 0.125 * 11 + 0.25 * 11 + 0.5 * 19 + 11) / 1.9375));
    mean.forget();
    CHECK(mean.take(2) == 2);
}
