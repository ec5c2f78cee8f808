#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "live_figure.h"
#include "momentum_keeper.h"
#include "softpoint/figure/articulated_controller.h"
#include "world_touches.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

struct __attribute__((visibility("hidden"))) ArticulatedController::Impl {
  Impl(btDiscreteDynamicsWorld& in, const FigureAnimation& what, int own_group, int own_mask,
       const ControllerSettings& how)
      : world(in),
        animation(what),
        settings(how),
        group(own_group),
        mask(own_mask),
        placer(what.model()),
        figure(what),
        impulses(what.model(), 200, 1e-8),
        momentum(what.model()),
        wanted(static_cast<std::size_t>(what.model().link_count()), 0),
        now(wanted),
        rates(static_cast<std::size_t>(what.model().velocity_count())),
        mean(rates) {}

  void publish();
  void choose();
  void advance(double dt);
  void advance_part(double dt, double left);
  void strike(double when, const FigureState& at, std::vector<double>& speed);
  void push_out(double left);
  // The contacts of the present state that can press within `ahead` s, `left` s before the step's end.
  void look(double left, double ahead);
  void place_capsules(double ahead);

  struct Body {
    LinkCapsule capsule;
    Vec3 middle;  // m, and
    Mat3 turn;    // its axis as z: in the link's frame
    std::unique_ptr<btCollisionShape> shape;
    std::unique_ptr<btRigidBody> body;
  };

  btDiscreteDynamicsWorld& world;
  const FigureAnimation& animation;
  ControllerSettings settings;
  int group, mask;
  FigureDynamics placer;
  LiveFigure figure;
  ContactImpulses impulses;
  MomentumKeeper momentum;
  WorldTouches touches;
  ControllerCounts counts;
  std::vector<Body> bodies;
  std::vector<btRigidBody*> shown;  // the bodies,
  std::vector<int> links;           // their links, -1 for what is not pushed back
  std::vector<char> wanted, now;    // per link: dynamic by set_dynamic(); all in all
  std::vector<double> rates, mean, by, answer;
  FigureState before;  // a push
  bool pressed = false;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
