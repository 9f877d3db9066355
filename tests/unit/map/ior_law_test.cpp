#include "saccade/map/ior_law.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/core/config_fields.hpp"

namespace saccade {
namespace {

/// The paper's law as it is written: every voxel is touched at every frame.
struct EagerTwin {
  double weight = 0.0;
  bool flag = false;

  void step(bool attended, const IorParameters& parameters) {
    if (attended) {
      weight += 1.0;
      if (!flag && weight >= parameters.ior_limit) {
        flag = true;
        weight *= parameters.mf;
      }
    } else {
      weight = std::max(0.0, weight - 1.0);
      if (weight == 0.0) flag = false;
    }
  }
};

TEST(IorLaw, EqualsThePapersEagerUpdateAtEveryTickOfRandomAttention) {
  std::mt19937 random(7);
  int flags_on = 0, flags_off = 0;
  for (int trial = 0; trial < 400; ++trial) {
    IorParameters parameters;
    parameters.ior_limit = std::uniform_int_distribution(1, 12)(random);
    parameters.mf = std::uniform_int_distribution(1, 6)(random);
    const double p_attend = std::uniform_real_distribution(0.05, 0.95)(random);
    EagerTwin twin;
    IorState state;
    Tick now{std::uniform_int_distribution<std::uint32_t>(0, 1000)(random)};
    bool attending = false;
    for (int step = 0; step < 600; ++step) {
      if (std::bernoulli_distribution(0.1)(random)) attending = std::bernoulli_distribution(p_attend)(random);
      const bool attended = attending != std::bernoulli_distribution(0.05)(random);
      if (attended) state = attend(state, now, parameters);
      const bool before = twin.flag;
      twin.step(attended, parameters);
      flags_on += !before && twin.flag;
      flags_off += before && !twin.flag;
      ++now.value;
      ASSERT_EQ(weight(state, now), twin.weight) << "step " << step;
      ASSERT_EQ(inhibited(state, now), twin.flag) << "step " << step;
    }
  }
  EXPECT_GT(flags_on, 1000);  // the sequences really reach the limit, and really forget
  EXPECT_GT(flags_off, 500);
}

TEST(IorLaw, KeepsTheFlagAsLongAsThePaperDoesWhenTheFactorIsFractional) {
  IorParameters parameters;
  parameters.ior_limit = 3;
  parameters.mf = 2.5;
  EagerTwin twin;
  IorState state;
  Tick now;
  for (int step = 0; step < 40; ++step) {
    const bool attended = step < 3 || step == 5;
    if (attended) state = attend(state, now, parameters);
    twin.step(attended, parameters);
    ++now.value;
    ASSERT_EQ(inhibited(state, now), twin.flag) << "step " << step;
    ASSERT_EQ(weight(state, now), std::ceil(twin.weight)) << "step " << step;
  }
}

TEST(IorLaw, SaturatesAtTheLastExpiryInsteadOfWrapping) {
  IorParameters parameters;
  parameters.ior_limit = 1;
  parameters.mf = 1000;
  const IorState state = attend({}, Tick{IorState::kLastExpiry - 5}, parameters);
  EXPECT_EQ(state.expiry(), IorState::kLastExpiry);
  EXPECT_TRUE(state.flag());
  EXPECT_EQ(weight(state, Tick{IorState::kLastExpiry}), 0u);
  EXPECT_EQ(IorState(0xFFFFFFFFu, false).expiry(), IorState::kLastExpiry);
}

TEST(IorLaw, ForgottenMemoryEqualsNone) {
  const IorState state(10, true);
  EXPECT_EQ(remembered(state, Tick{9}), state);
  EXPECT_EQ(remembered(state, Tick{10}), IorState{});
  EXPECT_FALSE(inhibited(state, Tick{10}));
  EXPECT_EQ(IorState::fromBits(state.bits()), state);
}

TEST(IorLaw, AttendedLeafIsFamiliarFromWhenItIsForgottenUntilItIsAttendedAgain) {
  const IorState never;
  EXPECT_FALSE(isFamiliar(never, Tick{1000}));
  const IorState attended = attend(never, Tick{0}, {});
  EXPECT_TRUE(wasAttended(attended));
  for (std::uint32_t now = 1; now < attended.expiry(); ++now) EXPECT_FALSE(isFamiliar(attended, Tick{now}));
  for (const std::uint32_t now : {attended.expiry(), 1000u}) {
    EXPECT_TRUE(isFamiliar(attended, Tick{now}));
    EXPECT_TRUE(isFamiliar(lasting(attended, Tick{now}), Tick{now}));
  }
  EXPECT_FALSE(isFamiliar(attend(attended, Tick{1000}, {}), Tick{1001}));
}

TEST(IorLaw, OfForgottenMemoryItLastsThatThereWasSome) {
  EXPECT_EQ(lasting(IorState(10, true), Tick{9}), IorState(10, true));
  EXPECT_EQ(lasting(IorState(10, true), Tick{10}), lasting(IorState(7, false), Tick{10}));
  EXPECT_EQ(lasting({}, Tick{10}), IorState{});
  for (const std::uint32_t now : {1u, 10u, IorState::kLastExpiry}) {
    const IorState forgotten = lasting(IorState(1, true), Tick{now});
    EXPECT_EQ(weight(forgotten, Tick{now}), 0u);
    EXPECT_FALSE(inhibited(forgotten, Tick{now}));
  }
}

TEST(IorLaw, RefusesParametersOutOfRange) {
  IorParameters parameters;
  EXPECT_NO_THROW(requireValid(parameters));
  parameters.ior_limit = 0;
  EXPECT_THROW(requireValid(parameters), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
