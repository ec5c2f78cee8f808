#include <Simbody.h>

#include <algorithm>

#include "benchmarks/figure_peers.h"

namespace softpoint::benchmarks {
namespace {

using figure::JointKind;

SimTK::Vec3 simbody(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

class SimbodyPeer : public FigurePeer {
 public:
  SimbodyPeer(const figure::FigureModel& model, const figure::FigureState& state)
      : matter_(system_), forces_(system_), gravity_(forces_, matter_, SimTK::Vec3(0, 0, -9.81)) {
    std::vector<SimTK::MobilizedBody> bodies;
    for (const figure::Link& link : model.links()) {
      const double mass = std::max(link.mass, 1e-9);
      const Vec3& c = link.center_of_mass;
      const Mat3 i = link.inertia + 1e-12 * Mat3::Identity() +
                     mass * (c.squaredNorm() * Mat3::Identity() - c * c.transpose());  // about the joint
      const SimTK::Body::Rigid body(SimTK::MassProperties(
          mass, simbody(c), SimTK::Inertia(i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2))));
      SimTK::MobilizedBody parent = matter_.Ground();
      if (link.parent >= 0) parent = bodies[static_cast<std::size_t>(link.parent)];
      if (link.joint == JointKind::kFree) {
        bodies.push_back(SimTK::MobilizedBody::Free(parent, SimTK::Transform(), body, SimTK::Transform()));
        continue;
      }
      const Mat3& o = link.orientation;
      const SimTK::Rotation turn(
          SimTK::Mat33(o(0, 0), o(0, 1), o(0, 2), o(1, 0), o(1, 1), o(1, 2), o(2, 0), o(2, 1), o(2, 2)));
      const SimTK::Rotation axis(SimTK::UnitVec3(simbody(link.axis)), SimTK::ZAxis);  // a pin turns about z
      bodies.push_back(SimTK::MobilizedBody::Pin(parent, SimTK::Transform(turn * axis, simbody(link.origin)),
                                                 body, SimTK::Transform(axis)));
    }
    state_ = system_.realizeTopology();
    for (int i = 0; i < model.link_count(); ++i) {
      const auto q = static_cast<std::size_t>(model.position_offset(i)),
                 v = static_cast<std::size_t>(model.velocity_offset(i));
      SimTK::MobilizedBody& body = bodies[static_cast<std::size_t>(i)];
      const int rates = body.getNumU(state_);
      // A free base stands upright at the origin, as it does by default.
      if (rates == 1) body.setOneQ(state_, 0, state.q[q]);
      for (int k = 0; k < rates; ++k) body.setOneU(state_, k, state.qd[v + static_cast<std::size_t>(k)]);
    }
    last_ = bodies.back();
    q_ = last_.getOneQ(state_, 0);
    u_ = last_.getOneU(state_, 0);
  }

  std::string name() const override { return "Simbody 3.7"; }
  void forward() override {
    // One number set anew, and all that hangs on positions and velocities is computed anew.
    last_.setOneQ(state_, 0, q_);
    last_.setOneU(state_, 0, u_);
    system_.realize(state_, SimTK::Stage::Acceleration);
  }
  double largest_acceleration() override {
    double most = 0;
    const SimTK::Vector& all = state_.getUDot();
    for (int k = 0; k < all.size(); ++k) most = std::max(most, std::abs(all[k]));
    return most;
  }

 private:
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::Force::UniformGravity gravity_;
  SimTK::State state_;
  SimTK::MobilizedBody last_;
  double q_ = 0, u_ = 0;
};

}  // namespace

std::unique_ptr<FigurePeer> simbody_peer(const figure::FigureModel& model, const figure::FigureState& state) {
  return std::make_unique<SimbodyPeer>(model, state);
}

}  // namespace softpoint::benchmarks
