#include <Eigen/Geometry>

#include <algorithm>
#include <vector>

#include "paper_kernels.h"
#include "paper_spheres.h"
#include "paper_stepper.h"
#include "softpoint/core/instruction_set.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

const PaperKernels& paper_kernels() {
  switch (best_instruction_set()) {
    case InstructionSet::kAvx512:
      return *paper_kernels_avx512();
    case InstructionSet::kAvx2:
      return *paper_kernels_avx2();
    case InstructionSet::kBaseline:
      break;
  }
  return *paper_kernels_baseline();
}

double run_forces(const PaperKernels& kernels, const PaperGrid<float>& grid) {
  return kernels.forces_single(grid);
}
double run_forces(const PaperKernels& kernels, const PaperGrid<double>& grid) {
  return kernels.forces_double(grid);
}
void run_accelerate(const PaperKernels& kernels, const PaperGrid<float>& grid, const PaperStep<float>& step) {
  kernels.accelerate_single(grid, step);
}
void run_accelerate(const PaperKernels& kernels, const PaperGrid<double>& grid,
                    const PaperStep<double>& step) {
  kernels.accelerate_double(grid, step);
}
void run_move(const PaperKernels& kernels, const PaperGrid<float>& grid, const PaperStep<float>& step) {
  kernels.move_single(grid, step);
}
void run_move(const PaperKernels& kernels, const PaperGrid<double>& grid, const PaperStep<double>& step) {
  kernels.move_double(grid, step);
}

template <class T>
class PaperSimd final : public PaperStepper {
 public:
  explicit PaperSimd(const PaperModel& model)
      : settings_(model.settings),
        columns_(model.pattern.columns),
        drag_rate_(model.fabric.drag_rate),
        kernels_(paper_kernels()),
        spheres_(columns_, model.pattern.rows, settings_.sphere_diameter, settings_.sphere_friction) {
    lay_out(model.pattern.rows);
    fill(model);
  }

  void set_point(int point, const Vec3& position, const Vec3& velocity) override {
    const std::ptrdiff_t i = place(point);
    for (int axis = 0; axis < 3; ++axis) {
      grid_.x[axis][i] = static_cast<T>(position[axis]);
      grid_.low[axis][i] = static_cast<T>(position[axis] - static_cast<double>(grid_.x[axis][i]));
      grid_.v[axis][i] = static_cast<T>(velocity[axis]);
    }
  }
  Vec3 position(int point) const override {
    const std::ptrdiff_t i = place(point);
    Vec3 out;
    for (int axis = 0; axis < 3; ++axis) {
      out[axis] = static_cast<double>(grid_.x[axis][i]) + static_cast<double>(grid_.low[axis][i]);
    }
    return out;
  }
  Vec3 velocity(int point) const override {
    const std::ptrdiff_t i = place(point);
    return Vec3(grid_.v[0][i], grid_.v[1][i], grid_.v[2][i]);
  }
  void set_velocity(int point, const Vec3& velocity) override {
    const std::ptrdiff_t i = place(point);
    for (int axis = 0; axis < 3; ++axis) grid_.v[axis][i] = static_cast<T>(velocity[axis]);
  }

  double forces() override { return run_forces(kernels_, grid_); }
  void accelerate(double h, double gauge, const Vec3& gravity) override {
    run_accelerate(kernels_, grid_, step(h, gauge, gravity, 0));
  }
  void collide(double h) override {
    if (spheres_.wanted()) spheres_.collide(*this, h);
  }
  void move(double h, double gauge, const Vec3& gravity, double friction) override {
    run_move(kernels_, grid_, step(h, gauge, gravity, friction));
  }

 private:
  std::ptrdiff_t place(int point) const {
    return grid_.first + (point / columns_) * grid_.stride + point % columns_;
  }

  PaperStep<T> step(double h, double gauge, const Vec3& gravity, double friction) const {
    return {static_cast<T>(h),
            static_cast<T>(gauge),
            static_cast<T>(drag_rate_),
            static_cast<T>(friction),
            {static_cast<T>(gravity.x()), static_cast<T>(gravity.y()), static_cast<T>(gravity.z())},
            settings_.friction == PaperFriction::kForces};
  }

  T* take(std::ptrdiff_t size) {
    blocks_.emplace_back(static_cast<std::size_t>(size), T(0));
    return blocks_.back().data();
  }

  void lay_out(int rows) {
    grid_.stride = columns_ + 1;
    grid_.rows = rows;
    grid_.first = grid_.stride + 16;
    size_ = grid_.first + (rows + 1) * grid_.stride + PaperGrid<T>::kPadding;
    blocks_.reserve(32);
    for (int axis = 0; axis < 3; ++axis) {
      grid_.x[axis] = take(size_);
      grid_.low[axis] = take(size_);
      grid_.v[axis] = take(size_);
      grid_.force[axis] = take(size_);
      grid_.air[axis] = take(size_);
    }
    grid_.scratch = take(2 * PaperGrid<T>::kRowArrays * (grid_.stride + PaperGrid<T>::kPadding));
    // Ghosts far from the cloth and from each other: springs between them have a length.
    for (std::ptrdiff_t i = 0; i < size_; ++i) {
      grid_.x[0][i] = static_cast<T>(100 + i % grid_.stride);
      grid_.x[1][i] = static_cast<T>(100 + i / grid_.stride);
    }
  }

  void fill(const PaperModel& model) {
    const ClothPattern& pattern = model.pattern;
    const std::ptrdiff_t s = grid_.stride;
    const std::ptrdiff_t offset[4] = {1, s, s + 1, s - 1};
    T* stiffness[4];
    for (int f = 0; f < 4; ++f) grid_.stiffness[f] = stiffness[f] = take(size_), grid_.rest[f] = T(1);
    for (const Spring& spring : pattern.springs) {
      const std::ptrdiff_t a = place(spring.a), b = place(spring.b);
      for (int f = 0; f < 4; ++f) {
        if (b - a != offset[f]) continue;
        stiffness[f][a] = static_cast<T>(spring.stiffness);
        grid_.rest[f] = static_cast<T>(spring.rest);
      }
    }
    T *slash = take(size_), *backslash = take(size_), *inverse_mass = take(size_), *real = take(size_);
    T* column = take(s + PaperGrid<T>::kPadding);
    double area = 0;
    for (const Triangle& t : pattern.faces) {
      const Vec3 &a = pattern.points[t[0]], &b = pattern.points[t[1]], &c = pattern.points[t[2]];
      area += 0.5 * (b - a).cross(c - a).norm();
      const int corner = std::min({t[0], t[1], t[2]});
      // The cell's first corner and the opposite one in one face: its diagonal runs between them.
      const int lowest_column = std::min({t[0] % columns_, t[1] % columns_, t[2] % columns_});
      const int cell = (corner / columns_) * columns_ + lowest_column, opposite = cell + columns_ + 1;
      bool has_first = false, has_last = false;
      for (int point : t) has_first |= point == cell, has_last |= point == opposite;
      (has_first && has_last ? slash : backslash)[place(cell)] = T(1.0 / 6);
    }
    for (int point = 0; point < pattern.point_count(); ++point) {
      inverse_mass[place(point)] = static_cast<T>(1 / pattern.masses[point]);
      real[place(point)] = 1;
      set_point(point, pattern.points[point], Vec3::Zero());
    }
    for (int i = 0; i < columns_; ++i) column[i] = 1;
    grid_.slash = slash;
    grid_.backslash = backslash;
    grid_.inverse_mass = inverse_mass;
    grid_.real = real;
    grid_.real_column = column;
    grid_.compression_ratio = static_cast<T>(model.fabric.compression_ratio);
    grid_.damping_time = static_cast<T>(model.fabric.damping_time);
    const bool constant = settings_.pressure == PaperPressure::kConstantArea;
    grid_.area_of_point = constant ? static_cast<T>(area / pattern.point_count()) : T(0);
  }

  PaperSettings settings_;
  int columns_;
  double drag_rate_;
  const PaperKernels& kernels_;
  std::ptrdiff_t size_ = 0;
  std::vector<std::vector<T>> blocks_;
  PaperGrid<T> grid_;
  PaperSpheres spheres_;
};

}  // namespace

std::unique_ptr<PaperStepper> make_simd_paper_stepper(const PaperModel& model) {
  if (model.settings.precision == Precision::kSingle) return std::make_unique<PaperSimd<float>>(model);
  return std::make_unique<PaperSimd<double>>(model);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
