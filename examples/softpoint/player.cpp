#include "player.h"

#include <chrono>
#include <utility>

#include "bullet_border.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

void add(FrameWork& work, const Profile& profile) {
  const Profile::Seconds& s = profile.seconds;
  work.seconds.predict += s.predict;
  work.seconds.detect += s.detect;
  work.seconds.compliance += s.compliance;
  work.seconds.solve += s.solve;
  work.seconds.commit += s.commit;
  work.seconds.mirror += s.mirror;
  const Profile::Counts& c = profile.counts;
  work.passes += c.passes;
  work.iterations += c.iterations;
  work.pairs += c.pairs;
  work.pairs_skipped += c.pairs_skipped;
  work.without_pairs += c.without_pairs;
  work.without_contacts += c.without_contacts;
}

}  // namespace

Player::Player(Scene scene)
    : scene_(std::move(scene)), overlays_(scene_.pictures.overlays), world_(scene_.world) {
  build_rigid_bodies();
  build_deformables();
  build_figures();
  handles_ = std::make_unique<HandleSet>(*system_, scene_.handles.size());
}

Player::~Player() {
  handles_.reset();
  system_.reset();
  for (std::size_t k = 0; k < rigid_.size(); ++k) {
    put({false, static_cast<int>(k)}, false);
  }
}

void Player::build_rigid_bodies() {
  for (const RigidBodySpec& spec : scene_.rigid_bodies) {
    try {
      rigid_.push_back(std::make_unique<RigidActor>(spec));
    } catch (const Error& error) {
      throw Error(scene_.file + ": body \"" + spec.name + "\": " + error.what());
    }
    rigid_present_.push_back(true);
    world_->addRigidBody(&rigid_.back()->body());
  }
}

void Player::build_deformables() {
  system_ = std::make_unique<DeformableSystem>(*world_, scene_.world.contact);
  for (const DeformableSpec& spec : scene_.deformables) {
    try {
      deformables_.push_back(spec.make({scene_.world, spec.placement, spec.motion, deformables_}));
    } catch (const Error& error) {
      throw Error(scene_.file + ": deformable \"" + spec.name + "\": " + error.what());
    }
    Deformable& body = *deformables_.back().body;
    body.setFriction(static_cast<btScalar>(spec.friction));
    body.setRestitution(static_cast<btScalar>(spec.restitution));
    if (!spec.may_sleep) {
      body.setActivationState(DISABLE_DEACTIVATION);
    }
    body.set_mirrored_normals(false);  // pictures have smooth ones of their own
    deformable_present_.push_back(true);
    switch_states_.emplace_back();
    system_->add(body);
  }
}

void Player::build_figures() {
  for (const FigureSpec& spec : scene_.figures) {
    try {
      figures_.push_back(std::make_unique<FigureActor>(spec, *world_));
    } catch (const Error& error) {
      throw Error(scene_.file + ": figure \"" + spec.name + "\": " + error.what());
    }
  }
}

void Player::step() {
  for (; next_event_ < scene_.events.size() &&
         scene_.events[next_event_].at <= time() + 1e-9 * scene_.world.time_step;
       ++next_event_) {
    apply(scene_.events[next_event_]);
  }
  work_ = {};
  const double dt = scene_.world.substep();
  for (int k = 0; k < scene_.world.substeps; ++k) {
    handles_->lead(time() + (k + 1) * dt);
    for (auto& figure : figures_) figure->hand_over_until(time() + k * dt + 1e-9 * dt);
    const auto start = std::chrono::steady_clock::now();
    world_->stepSimulation(static_cast<btScalar>(dt), 0);  // 0: this very step, whatever the clock says
    work_.step_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    add(work_, system_->profile());
  }
  work_.contacts = static_cast<long long>(system_->contacts().size());
  ++frame_;
}

bool Player::present(BodyRef body) const {
  return (body.deformable ? deformable_present_ : rigid_present_)[static_cast<std::size_t>(body.index)];
}

Vec3 Player::center(BodyRef body) const {
  const auto k = static_cast<std::size_t>(body.index);
  return body.deformable ? deformables_[k].body->center_of_mass()
                         : from_bullet(rigid_[k]->body().getWorldTransform().getOrigin());
}

Vec3 Player::near_point(const Vec3& near, bool from_body, BodyRef body) const {
  return from_body ? Vec3(center(body) + near) : near;
}

void Player::apply(const Event& event) {
  if (const auto* grab = std::get_if<GrabEvent>(&event.action)) {
    const BodyRef ref{true, grab->deformable};
    handles_->grab(*grab, *deformables_[static_cast<std::size_t>(grab->deformable)].body,
                   near_point(grab->near, grab->near_body, ref),
                   grab->to ? &rigid_[static_cast<std::size_t>(*grab->to)]->body() : nullptr);
  } else if (const auto* hold = std::get_if<HoldEvent>(&event.action)) {
    DeformableActor& actor = deformables_[static_cast<std::size_t>(hold->deformable)];
    handles_->hold(*hold, *actor.body, *actor.articulation);
  } else if (const auto* move = std::get_if<MoveEvent>(&event.action)) {
    handles_->move(*move, time());
  } else if (const auto* release = std::get_if<ReleaseEvent>(&event.action)) {
    handles_->release(release->handle);
  } else if (const auto* impulse = std::get_if<ImpulseEvent>(&event.action)) {
    apply(*impulse);
  } else {
    apply(std::get<ToggleEvent>(event.action));
  }
}

void Player::apply(const ImpulseEvent& event) {
  const auto k = static_cast<std::size_t>(event.body.index);
  const Vec3 near = near_point(event.near.value_or(Vec3::Zero()), event.near_body, event.body);
  if (!event.body.deformable) {
    btRigidBody& body = rigid_[k]->body();
    body.activate(true);
    const Vec3 arm = event.near ? Vec3(near - center(event.body)) : Vec3(Vec3::Zero());
    body.applyImpulse(to_bullet(event.impulse), to_bullet(arm));
    return;
  }
  Deformable& body = *deformables_[k].body;
  // Through the centre of mass: each vertex has its share by mass.
  const int only = event.near ? nearest_vertex(body, near) : -1;
  std::vector<char> done(body.points().size(), false);
  const auto faces = body.faces();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      const int v = faces[f][static_cast<std::size_t>(corner)];
      const auto at = static_cast<std::size_t>(v);
      if (done[at] || (only >= 0 && v != only)) {
        continue;
      }
      done[at] = true;
      const double share = only >= 0 ? 1.0 : body.masses()[at] / body.total_mass();
      body.apply_impulse(static_cast<int>(f), Vec3::Unit(corner), share * event.impulse);
    }
  }
}

void Player::apply(const ToggleEvent& event) {
  const auto flip = [&](bool& value) { value = event.on.value_or(!value); };
  switch (event.what) {
    case SwitchKind::kBody:
      put(event.body, event.on.value_or(!present(event.body)));
      break;
    case SwitchKind::kGravity:
      flip(gravity_on_);
      for (const auto& actor : rigid_) {
        if (actor->mass() > 0.0) {
          actor->body().activate(true);  // first: Bullet gives new gravity only to what is awake
        }
      }
      world_->setGravity(gravity_on_ ? to_bullet(scene_.world.gravity) : btVector3(0, 0, 0));
      break;
    case SwitchKind::kContacts:
      flip(overlays_.contacts);
      break;
    case SwitchKind::kForces:
      flip(overlays_.forces);
      break;
    case SwitchKind::kWireframe:
      flip(overlays_.wireframe);
      break;
    case SwitchKind::kPlugin: {
      const auto k = static_cast<std::size_t>(event.body.index);
      bool& on = switch_states_[k].try_emplace(event.switch_name, true).first->second;
      flip(on);
      deformables_[k].switches.at(event.switch_name)(on);
      break;
    }
  }
}

void Player::put(BodyRef body, bool wanted) {
  if (present(body) == wanted) {
    return;
  }
  const auto k = static_cast<std::size_t>(body.index);
  if (body.deformable) {
    Deformable& soft = *deformables_[k].body;
    if (wanted) {
      system_->add(soft);
    } else {
      system_->remove(soft);
      handles_->forget(soft);
    }
    deformable_present_[k] = wanted;
    return;
  }
  if (wanted) {
    world_->addRigidBody(&rigid_[k]->body());
  } else {
    if (handles_) {  // gone first when the player ends
      handles_->forget_carrier(rigid_[k]->body());
    }
    world_->removeRigidBody(&rigid_[k]->body());
  }
  rigid_present_[k] = wanted;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
