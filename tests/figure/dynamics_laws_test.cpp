// Forces and accelerations of random trees against the slow, obvious way: inertia matrix by unit
// accelerations.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>

#include "softpoint/figure/figure_dynamics.h"
#include "support.h"

namespace softpoint::figure {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

Eigen::Map<const Vector> mapped(const std::vector<double>& v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

struct Case {
  FigureModel model;
  FigureDynamics dynamics;
  FigureState state;
  std::vector<double> tau;
  std::vector<Wrench> loads;

  Case(RandomFigures& random, int links, bool floating)
      : model(random.model(links, floating)), dynamics(model), state(random.state(model)) {
    tau = random.numbers(model.velocity_count());
    for (int i = 0; i < 2; ++i) loads.push_back({random.below(links), random.vector(), random.vector()});
  }
  Matrix inertia() {
    Matrix h(model.velocity_count(), model.velocity_count());
    dynamics.inertia_matrix(state.q.data(), h.data());
    return h;
  }
};

template <class Check>
void on_random_trees(Check check) {
  RandomFigures random(3);
  for (int trial = 0; trial < 200; ++trial) {
    Case c(random, 1 + trial % 14, trial % 2 == 0);
    check(c, random);
  }
}

TEST(FigureDynamics, InertiaIsSymmetricPositiveDefiniteAndThatOfTheKineticEnergy) {
  double asymmetry = 0, energy = 0;
  on_random_trees([&](Case& c, RandomFigures&) {
    const Matrix h = c.inertia();
    asymmetry = std::max(asymmetry, (h - h.transpose()).norm() / h.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix>(h).eigenvalues()[0], 0);
    c.dynamics.place(c.state.q.data(), c.state.qd.data());
    const auto v = mapped(c.state.qd);
    const double t = 0.5 * v.dot(h * v);
    energy = std::max(energy, std::abs(c.dynamics.mechanics().kinetic_energy - t) / t);
  });
  std::printf("    asymmetry %.1e, kinetic energy off by %.1e\n", asymmetry, energy);
  EXPECT_LE(asymmetry, 1e-14);
  EXPECT_LE(energy, 1e-12);
}

// The paper's way is a method of its own: accelerations, responses, prescribed joints and implicit friction.
TEST(FigureDynamics, ThePapersWayAgreesWithArticulatedBodies) {
  double worst = 0;
  on_random_trees([&](Case& c, RandomFigures& random) {
    FigureDynamics paper(c.model);
    paper.set_method(ForwardMethod::kMatrix);
    EXPECT_EQ(paper.method(), ForwardMethod::kMatrix);
    const auto links = static_cast<std::size_t>(c.model.link_count());
    const auto dynamic = std::make_unique<bool[]>(links);
    for (std::size_t i = 0; i < links; ++i) dynamic[i] = random.below(3) > 0;
    std::vector<double> given = random.numbers(c.model.velocity_count());
    std::vector<double> by_matrix = given, change = given, change_by_matrix = given;
    for (FigureDynamics* way : {&c.dynamics, &paper}) {
      way->set_dynamic({dynamic.get(), links});
      way->set_base_acceleration({1, -2, 0.5});
      way->set_implicit_time(0.02);
    }
    const auto compare = [&](const std::vector<double>& a, const std::vector<double>& b) {
      worst = std::max(worst, (mapped(a) - mapped(b)).norm() / (1 + mapped(a).norm()));
    };
    c.dynamics.forward(c.state.q.data(), c.state.qd.data(), c.tau.data(), given.data(), c.loads);
    paper.forward(c.state.q.data(), c.state.qd.data(), c.tau.data(), by_matrix.data(), c.loads);
    compare(given, by_matrix);
    c.dynamics.respond(c.loads, change.data());
    paper.respond(c.loads, change_by_matrix.data());
    compare(change, change_by_matrix);
    c.dynamics.respond_to_torques(c.tau.data(), change.data());
    paper.respond_to_torques(c.tau.data(), change_by_matrix.data());
    compare(change, change_by_matrix);
    paper.set_method(ForwardMethod::kArticulated);
    paper.forward(c.state.q.data(), c.state.qd.data(), c.tau.data(), by_matrix.data(), c.loads);
    EXPECT_EQ(given, by_matrix);
  });
  std::printf("    off by %.1e\n", worst);
  EXPECT_LE(worst, 1e-10);
}

TEST(FigureDynamics, ArticulatedBodiesSolveTheInertiaMatrix) {
  double worst = 0;
  on_random_trees([&](Case& c, RandomFigures&) {
    const int n = c.model.velocity_count();
    std::vector<double> qdd(static_cast<std::size_t>(n)), b(qdd.size());
    c.dynamics.forward(c.state.q.data(), c.state.qd.data(), c.tau.data(), qdd.data(), c.loads);
    c.dynamics.bias(c.state.q.data(), c.state.qd.data(), b.data(), c.loads);
    const Vector expected = c.inertia().ldlt().solve(mapped(c.tau) - mapped(b));
    worst = std::max(worst, (mapped(qdd) - expected).norm() / expected.norm());
  });
  std::printf("    off by %.1e\n", worst);
  EXPECT_LE(worst, 1e-10);
}

TEST(FigureDynamics, HybridGivesTheTorquesAndAccelerationsItWasGiven) {
  double worst = 0;
  on_random_trees([&](Case& c, RandomFigures& random) {
    const auto links = static_cast<std::size_t>(c.model.link_count());
    const auto flags = std::make_unique<bool[]>(links);
    for (std::size_t i = 0; i < links; ++i) flags[i] = random.coin();
    c.dynamics.set_dynamic({flags.get(), links});
    std::vector<double> qdd = random.numbers(c.model.velocity_count()), given = qdd, tau = qdd;
    c.dynamics.forward(c.state.q.data(), c.state.qd.data(), c.tau.data(), qdd.data(), c.loads);
    c.dynamics.inverse(c.state.q.data(), c.state.qd.data(), qdd.data(), tau.data(), c.loads);
    for (int i = 0; i < c.model.link_count(); ++i) {
      for (int k = 0; k < velocity_count(c.model.links()[static_cast<std::size_t>(i)].joint); ++k) {
        const auto v = static_cast<std::size_t>(c.model.velocity_offset(i) + k);
        if (c.dynamics.dynamic(i)) {
          worst = std::max(worst, std::abs(tau[v] - c.tau[v]) / (1 + std::abs(qdd[v])));
        } else {
          EXPECT_EQ(qdd[v], given[v]);
        }
      }
    }
  });
  std::printf("    torques off by %.1e\n", worst);
  EXPECT_LE(worst, 1e-10);
}

// Newton and Euler written for the whole: what the joints do cancels.
TEST(FigureDynamics, LoadsAndGravityChangeTheMomentumOfAFreeFigure) {
  double linear = 0, angular = 0;
  on_random_trees([&](Case& c, RandomFigures&) {
    if (c.model.links()[0].joint != JointKind::kFree) return;
    const std::size_t n = c.state.qd.size();
    std::vector<double> qdd(n);
    c.dynamics.forward(c.state.q.data(), c.state.qd.data(), nullptr, qdd.data(), c.loads);
    Vec3 force = c.model.total_mass() * c.dynamics.gravity(), moment = Vec3::Zero();
    c.dynamics.place(c.state.q.data(), c.state.qd.data());
    moment += c.dynamics.mechanics().center_of_mass.cross(force);
    for (const Wrench& load : c.loads) {
      force += load.force;
      moment += load.moment + c.dynamics.motion(load.link).position.cross(load.force);
    }
    // Momentum is linear in the rates at one pose: its change by the accelerations, and by the pose at these
    // rates, which a central difference gives.
    const auto momentum_at = [&](double t) {
      std::vector<double> q = c.state.q, qd = c.state.qd;
      for (std::size_t k = 0; k < n; ++k) qd[k] += t * qdd[k];
      for (int i = 0; i < c.model.link_count(); ++i) {
        const int at = c.model.position_offset(i), v = c.model.velocity_offset(i);
        const JointKind kind = c.model.links()[static_cast<std::size_t>(i)].joint;
        const double* rate = c.state.qd.data() + v;
        double* to = q.data() + at;
        if (kind == JointKind::kHinge || kind == JointKind::kPrismatic) to[0] += t * rate[0];
        if (kind != JointKind::kBall && kind != JointKind::kFree) continue;
        const int shift = kind == JointKind::kFree ? 3 : 0;
        Eigen::Quaterniond turn(to[shift], to[shift + 1], to[shift + 2], to[shift + 3]);
        const Vec3 d = t * Vec3(rate[0], rate[1], rate[2]);
        const Eigen::Quaterniond by(Eigen::AngleAxisd(d.norm(), d.normalized()));
        turn = kind == JointKind::kFree ? by * turn : turn * by;
        for (int k = 0; k < 3 && kind == JointKind::kFree; ++k) to[k] += t * rate[3 + k];
        to[shift] = turn.w();
        to[shift + 1] = turn.x();
        to[shift + 2] = turn.y();
        to[shift + 3] = turn.z();
      }
      c.dynamics.place(q.data(), qd.data());
      return c.dynamics.mechanics();
    };
    const double t = 1e-5;
    const FigureMechanics before = momentum_at(-t), after = momentum_at(t);
    linear =
        std::max(linear, ((after.momentum - before.momentum) / (2 * t) - force).norm() / (1 + force.norm()));
    angular =
        std::max(angular, ((after.angular_momentum - before.angular_momentum) / (2 * t) - moment).norm() /
                              (1 + moment.norm()));
  });
  std::printf("    momentum off by %.1e, angular by %.1e\n", linear, angular);
  EXPECT_LE(linear, 1e-5);  // of the difference quotient
  EXPECT_LE(angular, 1e-5);
}

TEST(FigureDynamics, RespondIsTheDifferenceThatLoadsMake) {
  double worst = 0;
  on_random_trees([&](Case& c, RandomFigures& random) {
    std::vector<double> before(c.state.qd.size()), after(before), change(before);
    const std::vector<Wrench> more = {{random.below(c.model.link_count()), random.vector(), random.vector()}};
    c.dynamics.forward(c.state.q.data(), c.state.qd.data(), c.tau.data(), after.data(), more);
    c.dynamics.forward(c.state.q.data(), c.state.qd.data(), c.tau.data(), before.data());
    c.dynamics.respond(more, change.data());
    worst = std::max(worst,
                     (mapped(after) - mapped(before) - mapped(change)).norm() / (1 + mapped(after).norm()));
  });
  std::printf("    off by %.1e\n", worst);
  EXPECT_LE(worst, 1e-11);
  worst = 0;
  on_random_trees([&](Case& c, RandomFigures& random) {
    std::vector<double> before(c.state.qd.size()), after(before), change(before), none(before);
    const std::vector<double> push = random.numbers(c.model.velocity_count());
    c.dynamics.forward(c.state.q.data(), c.state.qd.data(), push.data(), after.data());
    c.dynamics.forward(c.state.q.data(), c.state.qd.data(), none.data(), before.data());
    c.dynamics.respond_to_torques(push.data(), change.data());
    worst = std::max(worst,
                     (mapped(after) - mapped(before) - mapped(change)).norm() / (1 + mapped(after).norm()));
  });
  std::printf("    torques: off by %.1e\n", worst);
  EXPECT_LE(worst, 1e-11);
}

// What is not dynamic and leads to nothing dynamic is left out; what only carries dynamic joints is moved,
// not weighed.
TEST(FigureDynamics, SkipsWhatNoDynamicJointNeeds) {
  std::vector<Link> links;
  const auto add = [&](int parent, JointKind joint) {
    Link link;
    link.name = std::to_string(links.size());
    link.parent = parent;
    link.joint = joint;
    link.origin = {0.1, 0, -0.3};
    set_cylinder(link, 1.0, 0.05, 0.3);
    links.push_back(link);
    return static_cast<int>(links.size()) - 1;
  };
  const int root = add(-1, JointKind::kFree);
  int arm = root, leg = root;
  for (int i = 0; i < 3; ++i) arm = add(arm, JointKind::kHinge);
  for (int i = 0; i < 20; ++i) leg = add(leg, JointKind::kHinge);
  const FigureModel model(links);
  FigureDynamics dynamics(model);
  const FigureState state = rest_state(model);
  std::vector<double> qdd(state.qd.size());
  const auto cost = [&] {
    const FigureDynamics::Counts before = dynamics.counts();
    dynamics.forward(state.q.data(), state.qd.data(), nullptr, qdd.data());
    return std::pair(dynamics.counts().placed - before.placed,
                     dynamics.counts().articulated - before.articulated);
  };
  EXPECT_EQ(cost(), std::pair(24LL, 24LL));
  dynamics.set_all_dynamic(false);
  EXPECT_EQ(cost(), std::pair(0LL, 0LL));
  bool flags[24] = {};
  for (int i = 1; i <= 3; ++i) flags[i] = true;
  dynamics.set_dynamic(flags);
  EXPECT_EQ(cost(), std::pair(4LL, 3LL));
  flags[3] = flags[1] = false;  // the hand follows a dynamic elbow
  dynamics.set_dynamic(flags);
  EXPECT_EQ(cost(), std::pair(4LL, 2LL));
}

}  // namespace
}  // namespace softpoint::figure
