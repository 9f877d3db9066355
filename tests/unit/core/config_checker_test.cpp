#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/core/config_fields.hpp"

namespace saccade {
namespace {

struct Inner {
  double theta = 0.3;
  void describe(ConfigVisitor& visitor) { visitor.number("theta", theta, {0.0, 1.0}, "", "a share"); }
};

struct Outer {
  int count = 3;
  std::string kind = "a";
  Inner inner;
  void describe(ConfigVisitor& visitor) {
    visitor.integer("count", count, {1.0, 10.0}, "px", "a count");
    visitor.text("kind", kind, {"a", "b"}, "a kind");
    visitor.section("inner", inner, "a section");
  }
};

TEST(ConfigChecker, AcceptsDefaults) {
  EXPECT_NO_THROW(requireValid(Outer{}));
}

TEST(ConfigChecker, ReportsAllBadFieldsTogetherWithTheirFullNames) {
  Outer bad;
  bad.count = 0;
  bad.kind = "z";
  bad.inner.theta = std::numeric_limits<double>::quiet_NaN();
  try {
    requireValid(bad);
    FAIL() << "accepted a bad config";
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("count: expected 1 to 10 px, found 0"), std::string::npos) << what;
    EXPECT_NE(what.find("kind: expected one of a, b, found \"z\""), std::string::npos) << what;
    EXPECT_NE(what.find("inner.theta: expected 0 to 1"), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace saccade
