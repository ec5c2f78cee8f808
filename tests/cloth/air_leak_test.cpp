// Leak, limits of suction, sealing and adhesion of the rim.
#include <gtest/gtest.h>

#include <cmath>

#include "air_leak.h"
#include "air_sheet.h"

namespace softpoint::cloth {
namespace {

constexpr double kAmbient = 101325;

TEST(Leak, FollowsTheExponential) {
  // Inflow through one opening: dp/dt = p_a G/V (p_a - p).
  const double volume = 4e-4, conductance = 1e-9, rate = kAmbient * conductance / volume;
  for (const double start : {0.0, 0.5, 0.9}) {
    double air = start * kAmbient * volume;
    const int steps = 10000;
    const double time = 2 / rate, dt = time / steps;
    const Opening opening{conductance, 0};
    for (int i = 0; i < steps; ++i) air = air_after_leak(air, volume, dt, kAmbient, 0, {&opening, 1});
    const double exact = kAmbient * (1 - (1 - start) * std::exp(-rate * time));
    EXPECT_NEAR(air / volume, exact, 1e-4 * kAmbient * (1 - start));
    // Of one implicit step: exactly 1/(1 + rate dt).
    const double one =
        air_after_leak(start * kAmbient * volume, volume, 1 / rate, kAmbient, 0, {&opening, 1});
    EXPECT_NEAR(one / volume, kAmbient * (1 - (1 - start) / 2), 1e-10 * kAmbient);
  }
}

TEST(Leak, OutwardFollowsTheLogisticCurve) {
  // Outflow carries air at the inner pressure: dp/dt = -p G/V (p - p_a).
  const double volume = 4e-4, conductance = 1e-9, rate = kAmbient * conductance / volume;
  double air = 2 * kAmbient * volume;
  const int steps = 10000;
  const double time = 1 / rate;
  const Opening opening{conductance, 0};
  for (int i = 0; i < steps; ++i) air = air_after_leak(air, volume, time / steps, kAmbient, 0, {&opening, 1});
  const double exact = kAmbient / (1 - 0.5 * std::exp(-rate * time));
  EXPECT_NEAR(air / volume, exact, 1e-4 * kAmbient);
}

TEST(Leak, NeverPassesTheAtmosphereAndStopsAtItsThreshold) {
  for (const double start : {0.0, 0.3, 0.99, 1.01, 3.0, 100.0}) {
    for (const double dt : {1e-6, 1.0 / 60, 10.0, 1e9}) {
      for (const double threshold : {0.0, 730.0, 5800.0}) {
        const Opening openings[] = {{1e-3, threshold}, {1e-9, 2 * threshold}};
        const double volume = 1e-4;
        const double after =
            air_after_leak(start * kAmbient * volume, volume, dt, kAmbient, 0, openings) / volume;
        const double before = start * kAmbient;
        EXPECT_LE(std::abs(after - kAmbient), std::abs(before - kAmbient) + 1e-9);
        EXPECT_GE((after - kAmbient) * (before - kAmbient), -1e-6);
        const double least = std::min(std::abs(before - kAmbient), threshold);
        EXPECT_GE(std::abs(after - kAmbient), least - 1e-6);
        if (dt > 1e3) {
          EXPECT_NEAR(std::abs(after - kAmbient), least, 1e-2);
        }
      }
    }
  }
}

// A sealed tent over the middle of the sheet.
AirSheet tent(AirSettings settings, double saturation = 1) {
  AirSheet sheet(settings, 50, 0.3, saturation);
  sheet.lift([](double x, double y) { return bump(x, y, 0.02, 0.1); });
  sheet.find();
  return sheet;
}

TEST(Suction, EndsAtTheBubblePointOfTheWeave) {
  AirSettings settings = sealed();
  settings.limit_suction = true;
  settings.pore_diameter = 50e-6;
  EXPECT_NEAR(bubble_point(settings), 5824, 1);
  AirSheet sheet = tent(settings);
  EXPECT_DOUBLE_EQ(sheet.finder.pockets()[0].max_suction, bubble_point(settings));
  EXPECT_DOUBLE_EQ(sheet.finder.pockets()[0].min_pressure, 2340);
  sheet.lift([](double x, double y) { return bump(x, y, 0.04, 0.1); });
  sheet.find();
  sheet.exchange(1.0 / 60);
  // The volume has doubled: air burst in until suction stood at its limit.
  EXPECT_NEAR(sheet.air(0) / sheet.volume(0), kAmbient - bubble_point(settings), 1e-6 * kAmbient);
  EXPECT_LT(sheet.finder.vented(), 0);
  EXPECT_LT(std::abs(sheet.finder.audit()), 1e-9 * sheet.finder.initial_air());
}

TEST(Suction, HasNoLimitWhenSwitchedOff) {
  AirSheet sheet = tent(sealed());
  EXPECT_EQ(sheet.finder.pockets()[0].max_suction, AirPocket{}.max_suction);
  EXPECT_EQ(sheet.finder.pockets()[0].min_pressure, 0);
  const double air = sheet.air(0);
  sheet.lift([](double x, double y) { return bump(x, y, 0.04, 0.1); });
  sheet.find();
  sheet.exchange(1.0 / 60);
  EXPECT_DOUBLE_EQ(sheet.air(0), air);
}

TEST(Weave, LeaksByTheCubeOfItsDryPores) {
  AirSettings settings = sealed();
  settings.leak = true;
  double flows[3];
  int i = 0;
  for (const double saturation : {0.3, 0.65, 1.0}) {
    AirSheet sheet = tent(settings, saturation);
    const double before = sheet.air(0);
    sheet.lift([](double x, double y) { return bump(x, y, 0.0201, 0.1); });  // 0.5 %: some 500 Pa
    sheet.find();
    sheet.exchange(1e-9);
    flows[i++] = sheet.air(0) - before;
  }
  EXPECT_GT(flows[0], 0);
  EXPECT_NEAR(flows[1] / flows[0], std::pow(0.35 / 0.7, 3), 1e-3);
  EXPECT_EQ(flows[2], 0) << "under the bubble point pores full of water let nothing through";
}

TEST(Weave, ThatIsHardlyWetFillsItsBubbleWithinAFrame) {
  AirSettings settings = sealed();
  settings.leak = true;
  AirSheet sheet = tent(settings, 0.3);
  sheet.lift([](double x, double y) { return bump(x, y, 0.04, 0.1); });
  sheet.find();
  sheet.exchange(1.0 / 60);
  EXPECT_GT(sheet.air(0) / sheet.volume(0), 0.98 * kAmbient);
}

// A bubble whose wall is the border of the sheet itself, at this gap.
AirSheet rim_at(double gap, AirSettings settings, double saturation = 1) {
  AirSheet sheet(settings, 50, 0.3, saturation);
  sheet.lift([&](double x, double) { return x > 0.149 ? gap : 0.02 * (0.15 + x) / 0.3; });
  for (std::size_t i = 0; i < sheet.positions.size(); ++i) {
    const Vec3& at = sheet.pattern.points[i];
    if (std::max(std::abs(at.x()), std::abs(at.y())) > 0.149) sheet.positions[i].z() = gap;
  }
  sheet.measure(foot_on_plane);
  sheet.find();
  return sheet;
}

TEST(Rim, IsSealedWhileItIsWetAndThePressureUnderThatOfTheFilm) {
  AirSettings settings = sealed();
  settings.vent = true;
  const double gap = 5e-4, holds = film_pressure(settings, gap);
  EXPECT_NEAR(holds, 2 * 0.0728 / gap, 1e-9);
  for (const double part : {0.9, 1.1}) {
    AirSheet sheet = rim_at(gap, settings);
    ASSERT_EQ(sheet.pockets(), 1);
    ASSERT_FALSE(sheet.finder.pockets()[0].open);
    const double volume = sheet.volume(0) * kAmbient / (kAmbient - part * holds);
    const double before = sheet.air(0);
    const std::vector<double> volumes{volume};
    sheet.finder.exchange(1.0 / 60, volumes);
    if (part < 1) {
      EXPECT_EQ(sheet.air(0), before);
    } else {
      EXPECT_NEAR(sheet.air(0) / volume, kAmbient - holds, 1e-2 * holds);
    }
  }
  AirSheet dry = rim_at(gap, settings, 0.2);
  EXPECT_EQ(dry.pockets(), 0) << "dry cloth has no bubbles";
}

TEST(Rim, ThatLiftsOffOpensTheBubbleAndClosesItWithFreshAir) {
  AirSettings settings = sealed();
  settings.vent = true;
  AirSheet sheet = rim_at(5e-4, settings);
  EXPECT_FALSE(sheet.finder.pockets()[0].open);
  AirSheet open = rim_at(5e-3, settings);
  EXPECT_TRUE(open.finder.pockets()[0].open);
  EXPECT_FALSE(open.find()) << "there is no pressure to solve";
  open.exchange(1.0 / 60);
  EXPECT_NEAR(open.air(0), kAmbient * open.volume(0), 1e-9);
  // Lifted higher it stays open, and takes in what it needs.
  open.lift([](double, double) { return 0.05; });
  open.find();
  EXPECT_NEAR(open.air(0), kAmbient * open.volume(0), 1e-9 * open.air(0));
  EXPECT_LT(std::abs(open.finder.audit()), 1e-9 * open.finder.initial_air());
  // Out of reach of any collider it is open too.
  AirSheet far = rim_at(5e-4, settings);
  for (std::size_t i = 0; i < far.gaps.size(); ++i) {
    if (far.pattern.points[i].x() > 0.1) far.gaps[i] = std::numeric_limits<double>::infinity();
  }
  far.find();
  ASSERT_EQ(far.pockets(), 1);
  EXPECT_TRUE(far.finder.pockets()[0].open);
  // Without venting the rim is sealed whatever its gap: the thesis.
  AirSheet thesis = rim_at(5e-3, sealed());
  EXPECT_FALSE(thesis.finder.pockets()[0].open);
}

TEST(Film, PullsWithTheWorkOfAdhesion) {
  AirSettings settings;
  // Of the receding film; the rest of the way to infinity is 1/101 of it.
  double work = 0;
  const double end = 100 * settings.film_gap, step = settings.film_gap / 1000;
  for (double gap = step / 2; gap < end; gap += step) work += film_adhesion(settings, gap) * step;
  EXPECT_NEAR(work, 2 * settings.surface_tension * (1 - 1.0 / 101), 1e-5 * work);
  EXPECT_NEAR(film_pressure(settings, 0), 728, 1e-9);
}

TEST(Film, HoldsTheWetRimAndNothingElse) {
  AirSettings settings = sealed();
  settings.adhesion = true;
  AirSheet sheet(settings);
  for (std::size_t i = 0; i < sheet.saturations.size(); ++i) {
    if (sheet.pattern.points[i].y() < 0) sheet.saturations[i] = 0;
  }
  sheet.finder.set_saturation(sheet.saturations);
  sheet.lift([](double x, double y) { return bump(x, y, 0.02, 0.1); });
  sheet.find();
  double border = 0, around = 0;
  for (std::size_t i = 0; i < sheet.positions.size(); ++i) {
    const Vec3& at = sheet.pattern.points[i];
    const double force = sheet.finder.adhesion()[i];
    if (at.y() < 0 || at.head<2>().norm() < 0.09) {
      EXPECT_EQ(force, 0) << "dry, or in the bubble";
    } else if (std::max(std::abs(at.x()), std::abs(at.y())) > 0.149) {
      EXPECT_NEAR(force, 728 * sheet.finder.topology().point_areas[i], 1e-9);
      border += force;
    } else if (at.head<2>().norm() > 0.115) {
      EXPECT_EQ(force, 0) << "in the middle of the patch there is no meniscus";
    } else {
      around += force;
    }
  }
  EXPECT_GT(border, 0);
  EXPECT_GT(around, 0);
  settings.adhesion = false;
  AirSheet off(settings);
  off.find();
  for (const double force : off.finder.adhesion()) EXPECT_EQ(force, 0);
}

}  // namespace
}  // namespace softpoint::cloth
