#include "figure_prescription.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "csv_table.h"
#include "figure_joints.h"
#include "json_document.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

using figure::CubicSpline;
using figure::JointKind;
using figure::TurnSpline;

namespace {

constexpr const char* kTurnFields[] = {".qw", ".qx", ".qy", ".qz"};
constexpr const char* kPlaceFields[] = {".px", ".py", ".pz"};

// The joint that a column belongs to: all of its name, or what stands before the field.
int joint_of(const figure::FigureModel& model, const std::string& column, const std::string& where) {
  const std::size_t dot = column.rfind('.');
  if (dot != std::string::npos && column.size() - dot == 3) {
    for (int i = 0; i < model.link_count(); ++i) {
      const figure::Link& link = model.links()[static_cast<std::size_t>(i)];
      if ((link.joint == JointKind::kBall || link.joint == JointKind::kFree) &&
          model.joint_name(i) == column.substr(0, dot)) {
        return i;
      }
    }
  }
  return find_joint(model, column, where);
}

}  // namespace

FigurePrescription::FigurePrescription(std::string_view text, const std::string& file,
                                       const figure::FigureModel& model) {
  const CsvTable table(text, file);
  if (table.columns().empty() || table.columns()[0] != "t") {
    throw Error(file + ": the first column is '" + (table.columns().empty() ? "" : table.columns()[0]) +
                "'; permitted is t, the time");
  }
  const auto joints = static_cast<std::size_t>(model.link_count());
  std::vector<std::size_t> used(joints, 0);
  for (std::size_t c = 1; c < table.columns().size(); ++c) {
    ++used[static_cast<std::size_t>(joint_of(model, table.columns()[c], file + " column"))];
  }
  const std::vector<double> times = table.column(0);
  try {
    for (std::size_t i = 0; i < joints; ++i) {
      if (used[i] == 0) continue;
      const figure::Link& link = model.links()[i];
      const std::string& joint = model.joint_name(static_cast<int>(i));
      const int q = model.position_offset(static_cast<int>(i)),
                v = model.velocity_offset(static_cast<int>(i));
      std::size_t wanted = 1;
      if (link.joint == JointKind::kHinge || link.joint == JointKind::kPrismatic) {
        lines_.push_back({q, v, CubicSpline(times, table.column(joint))});
      } else {
        const bool free = link.joint == JointKind::kFree;
        wanted = free ? 7 : 4;
        std::vector<std::array<double, 4>> turns(times.size());
        for (std::size_t k = 0; k < 4; ++k) {
          const std::vector<double> numbers = table.column(joint + kTurnFields[k]);
          for (std::size_t row = 0; row < numbers.size(); ++row) turns[row][k] = numbers[row];
        }
        turns_.push_back({free ? q + 3 : q, v, free, TurnSpline(times, std::move(turns))});
        for (int k = 0; k < 3 && free; ++k) {
          lines_.push_back({q + k, v + 3 + k, CubicSpline(times, table.column(joint + kPlaceFields[k]))});
        }
      }
      if (used[i] != wanted) {
        throw Error(fmt::format("joint '{}' ({}) has {} columns; permitted are {}", joint, name(link.joint),
                                used[i], wanted));
      }
      links_.push_back(static_cast<int>(i));
    }
  } catch (const Error& error) {
    const std::string message = error.what();
    throw Error(message.rfind(file, 0) == 0 ? message : file + ": " + message);
  }
  if (links_.empty()) throw Error(file + ": no column but t; permitted is a joint at least");
  first_time_ = times.front();
  last_time_ = times.back();
}

void FigurePrescription::evaluate(double time, double* q, double* qd, double* qdd) const {
  for (const Line& line : lines_) {
    const figure::SplinePoint p = line.curve.at(time);
    q[line.q] = p.value;
    qd[line.v] = p.rate;
    qdd[line.v] = p.acceleration;
  }
  for (const Turn& turn : turns_) {
    figure::TurnSplinePoint p = turn.curve.at(time);
    if (turn.free) {
      const Eigen::Quaterniond to_world(p.turn[0], p.turn[1], p.turn[2], p.turn[3]);
      p.spin = to_world * p.spin;
      p.spin_change = to_world * p.spin_change;  // what the turning axes add is spin x spin
    }
    std::copy_n(p.turn.data(), 4, q + turn.q);
    std::copy_n(p.spin.data(), 3, qd + turn.v);
    std::copy_n(p.spin_change.data(), 3, qdd + turn.v);
  }
}

FigurePrescription read_figure_prescription(const std::filesystem::path& path,
                                            const figure::FigureModel& model) {
  return {read_text_file(path), path.string(), model};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
