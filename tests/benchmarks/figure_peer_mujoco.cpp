// Links without mass hold a further joint of the next body, as that engine's own models have it.
#include <mujoco/mujoco.h>

#include <cstdio>
#include <fstream>

#include "benchmarks/figure_peers.h"
#include "softpoint/core/error.h"
#include "support/temporary_folder.h"

namespace softpoint::benchmarks {
namespace {

using figure::JointKind;

std::string numbers(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) {
    text += to_text(value);
    text += ' ';
  }
  return text;
}
std::string numbers(const Vec3& v) { return numbers({v.x(), v.y(), v.z()}); }

void put_body(const figure::FigureModel& model, int link, Vec3 origin,
              std::vector<std::pair<int, Vec3>> joints, std::string& text) {
  const figure::Link& l = model.links()[static_cast<std::size_t>(link)];
  for (auto& [joint, place] : joints) place -= l.origin;  // in the axes of this body, all aligned
  joints.push_back({link, Vec3::Zero()});
  origin += l.origin;
  std::vector<int> children;
  for (int i = link + 1; i < model.link_count(); ++i) {
    if (model.links()[static_cast<std::size_t>(i)].parent == link) children.push_back(i);
  }
  if (l.mass == 0 && children.size() == 1) {
    put_body(model, children[0], origin, joints, text);
    return;
  }
  text += "<body pos='" + numbers(origin) + "'>";
  const Mat3& i = l.inertia;
  text += "<inertial pos='" + numbers(l.center_of_mass) + "' mass='" + to_text(l.mass) + "' fullinertia='" +
          numbers({i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)}) + "'/>";
  for (const auto& [joint, place] : joints) {
    const figure::Link& j = model.links()[static_cast<std::size_t>(joint)];
    if (j.joint == JointKind::kFree) {
      text += "<freejoint/>";
    } else {
      text += "<joint name='" + j.name + "' type='hinge' axis='" + numbers(j.axis) + "' pos='" +
              numbers(place) + "'/>";
    }
  }
  for (const int child : children) put_body(model, child, Vec3::Zero(), {}, text);
  text += "</body>";
}

class MujocoPeer : public FigurePeer {
 public:
  MujocoPeer(const figure::FigureModel& model, const figure::FigureState& state, bool whole) : whole_(whole) {
    std::string text = "<mujoco><compiler angle='radian' inertiafromgeom='false'/><worldbody>";
    put_body(model, 0, Vec3::Zero(), {}, text);
    text += "</worldbody></mujoco>";
    const TemporaryFolder folder;
    const std::string file = (folder.path() / "figure.xml").string();
    std::ofstream(file) << text;
    char error[1000] = "";
    model_ = mj_loadXML(file.c_str(), nullptr, error, sizeof error);
    if (model_ == nullptr) throw Error(std::string("MuJoCo: ") + error);
    data_ = mj_makeData(model_);
    for (int i = 0; i < model.link_count(); ++i) {
      const figure::Link& link = model.links()[static_cast<std::size_t>(i)];
      const auto q = static_cast<std::size_t>(model.position_offset(i)),
                 v = static_cast<std::size_t>(model.velocity_offset(i));
      if (link.joint == JointKind::kFree) {
        std::copy_n(&state.q[q], 7, data_->qpos);
        std::copy_n(&state.qd[v + 3], 3, data_->qvel);
        std::copy_n(&state.qd[v], 3, data_->qvel + 3);  // of a base that stands upright: axes agree
        continue;
      }
      const int joint = mj_name2id(model_, mjOBJ_JOINT, link.name.c_str());
      data_->qpos[model_->jnt_qposadr[joint]] = state.q[q];
      data_->qvel[model_->jnt_dofadr[joint]] = state.qd[v];
    }
    mj_forward(model_, data_);
    bias_.resize(static_cast<std::size_t>(model_->nv));
    solved_.resize(bias_.size());
  }
  ~MujocoPeer() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  MujocoPeer(const MujocoPeer&) = delete;
  MujocoPeer& operator=(const MujocoPeer&) = delete;

  std::string name() const override {
    return std::string("MuJoCo ") + mj_versionString() +
           (whole_ ? ", from positions to accelerations" : ", crb, factor, rne");
  }
  void forward() override {
    if (whole_) {
      mj_kinematics(model_, data_);
      mj_comPos(model_, data_);
      mj_comVel(model_, data_);
    }
    mj_crb(model_, data_);
    mj_factorM(model_, data_);
    mj_rne(model_, data_, 0, bias_.data());
    if (!whole_) return;
    for (double& b : bias_) b = -b;
    mj_solveM(model_, data_, solved_.data(), bias_.data(), 1);
  }
  double largest_acceleration() override {
    double most = 0;
    for (int k = 0; k < model_->nv; ++k) most = std::max(most, std::abs(data_->qacc[k]));
    return most;
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  bool whole_;
  std::vector<double> bias_, solved_;
};

}  // namespace

std::unique_ptr<FigurePeer> mujoco_peer(const figure::FigureModel& model, const figure::FigureState& state,
                                        bool whole) {
  return std::make_unique<MujocoPeer>(model, state, whole);
}

}  // namespace softpoint::benchmarks
