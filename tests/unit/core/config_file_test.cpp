#include "saccade/core/config_file.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

struct Inner {
  double theta = 0.3;
  std::vector<double> thresholds = {0.6, 0.7};
  void describe(ConfigVisitor& visitor) {
    visitor.number("theta", theta, {0.0, 1.0}, "", "a share");
    visitor.numbers("thresholds", thresholds, {0.0, 1.0}, "", "some shares");
  }
};

struct Outer {
  int count = 3;
  bool fast = true;
  std::string kind = "a";
  Inner inner;
  void describe(ConfigVisitor& visitor) {
    visitor.integer("count", count, {1.0, 10.0}, "px", "a count");
    visitor.flag("fast", fast, "whether");
    visitor.text("kind", kind, {"a", "b \"quoted\""}, "a kind");
    visitor.section("inner", inner, "a section");
  }
};

TEST(ConfigFile, WhatIsPrintedReadsBackAsTheSameConfig) {
  Outer written;
  written.count = 7;
  written.fast = false;
  written.kind = "b \"quoted\"";
  written.inner.theta = 0.1 + 0.2;
  written.inner.thresholds = {0.25, 1.0 / 3.0, 1.0};
  for (const bool explain : {false, true}) {
    Outer read;
    applyConfigText(printConfig(describing(written), explain), "text", describing(read));
    EXPECT_EQ(read.count, written.count);
    EXPECT_EQ(read.fast, written.fast);
    EXPECT_EQ(read.kind, written.kind);
    EXPECT_EQ(read.inner.theta, written.inner.theta);
    EXPECT_EQ(read.inner.thresholds, written.inner.thresholds);
  }
}

TEST(ConfigFile, FieldsThatTheTextDoesNotNameKeepTheirValues) {
  Outer config;
  applyConfigText("inner: {theta: 0.5}\n", "text", describing(config));
  EXPECT_EQ(config.count, 3);
  EXPECT_EQ(config.inner.theta, 0.5);
}

TEST(ConfigFile, UnknownKeysAndBadValuesAreReportedTogether) {
  Outer config;
  try {
    applyConfigText("count: many\ninner: {theta: 2, thetta: 0.1}\nkind: c\n", "my.yaml", describing(config));
    FAIL() << "accepted a bad file";
  } catch (const IoError& error) {
    const std::string what = error.what();
    for (const char* part : {"my.yaml", "count: expected a whole number", "inner.thetta: expected one of the keys",
                             "inner.theta: expected 0 to 1, found 2", "kind: expected one of"}) {
      EXPECT_NE(what.find(part), std::string::npos) << part << " is missing in: " << what;
    }
  }
}

TEST(ConfigFile, AFileThatCannotBeReadIsAnErrorAndNeverMeansDefaults) {
  Outer config;
  EXPECT_THROW(applyConfigFile("no/such/file.yaml", describing(config)), IoError);
}

TEST(ConfigFile, BrokenYamlAndListsWhereSectionsAreExpectedAreErrors) {
  Outer config;
  EXPECT_THROW(applyConfigText("inner: [1, 2", "text", describing(config)), IoError);
  EXPECT_THROW(applyConfigText("inner: [1, 2]", "text", describing(config)), IoError);
  EXPECT_THROW(applyConfigText("- 1\n- 2\n", "text", describing(config)), IoError);
  EXPECT_NO_THROW(applyConfigText("", "text", describing(config)));
}

TEST(ConfigFile, SettingsOfTheCommandLineReachNestedFields) {
  Outer config;
  applyConfigSettings({"inner.theta=0.75", "count=4", "inner.thresholds=[0.5]"}, describing(config));
  EXPECT_EQ(config.inner.theta, 0.75);
  EXPECT_EQ(config.count, 4);
  EXPECT_EQ(config.inner.thresholds, std::vector<double>{0.5});
  EXPECT_THROW(applyConfigSettings({"inner.theta"}, describing(config)), std::invalid_argument);
  EXPECT_THROW(applyConfigSettings({"inner.nothing=1"}, describing(config)), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
