#include "quadrature.h"

#include <cmath>
#include <numbers>
#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

constexpr int kSmallMesh = 500;  // vertices

// Nodes and weights of Gauss-Legendre quadrature on (0, 1): Newton's method on the Legendre polynomial.
void gauss_legendre(int n, std::vector<double>& nodes, std::vector<double>& weights) {
  nodes.resize(n);
  weights.resize(n);
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    double slope = 1.0;
    for (int step = 0; step < 100; ++step) {
      double p = 1.0, before = 0.0;
      for (int k = 1; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = n * (x * p - before) / (x * x - 1.0);
      const double change = p / slope;
      x -= change;
      if (std::abs(change) < 1e-16) break;
    }
    nodes[i] = 0.5 * (1.0 - x);
    weights[i] = 1.0 / ((1.0 - x * x) * slope * slope);
  }
}

void add_orbit3(Rule& rule, double a, double weight) {
  const double b = 1.0 - 2.0 * a;
  rule.push_back({a, a, weight});
  rule.push_back({a, b, weight});
  rule.push_back({b, a, weight});
}

void add_orbit6(Rule& rule, double a, double b, double weight) {
  const double c = 1.0 - a - b;
  for (const auto& [p, q] : {std::pair{a, b}, {b, a}, {b, c}, {c, b}, {a, c}, {c, a}}) {
    rule.push_back({p, q, weight});
  }
}

void normalise(Rule& rule) {
  double sum = 0.0;
  for (const RulePoint& p : rule) sum += p.weight;
  for (RulePoint& p : rule) p.weight /= sum;
}

}  // namespace

Quadrature Quadrature::resolved(int vertices) const {
  const auto is_plain = [](int n) { return n == 3 || n == 6 || n == 12; };
  if (far_points != 0 && far_points != 1 && !is_plain(far_points)) {
    throw Error("quadrature.far_points = " + std::to_string(far_points) + ": permitted is 0, 1, 3, 6 or 12");
  }
  if (near_points != 0 && !is_plain(near_points)) {
    throw Error("quadrature.near_points = " + std::to_string(near_points) + ": permitted is 0, 3, 6 or 12");
  }
  if (near_graded_order != 0 && (near_graded_order < 2 || near_graded_order > 16)) {
    throw Error("quadrature.near_graded_order = " + std::to_string(near_graded_order) +
                ": permitted is 0 or 2 to 16");
  }
  if (near_points != 0 && near_graded_order != 0) {
    throw Error("quadrature.near_graded_order = " + std::to_string(near_graded_order) +
                ": permitted is 0 when near_points is set");
  }
  check_range("quadrature.near_distance", near_distance, 1.0, 10.0);
  Quadrature result = *this;
  const bool small = vertices < kSmallMesh;
  if (far_points == 0) result.far_points = small ? 6 : 3;
  if (near_points == 0 && near_graded_order == 0) {
    (small ? result.near_graded_order : result.near_points) = small ? 6 : 12;
  }
  return result;
}

Rule symmetric_rule(int points) {
  Rule rule;
  if (points == 1) {
    rule.push_back({1.0 / 3.0, 1.0 / 3.0, 1.0});
  } else if (points == 3) {
    add_orbit3(rule, 1.0 / 6.0, 1.0 / 3.0);
  } else if (points == 6) {
    const double root10 = std::sqrt(10.0);
    const double a = std::sqrt(38.0 - 44.0 * std::sqrt(0.4));
    const double w = std::sqrt(213125.0 - 53320.0 * root10);
    add_orbit3(rule, (8.0 - root10 + a) / 18.0, (620.0 + w) / 3720.0);
    add_orbit3(rule, (8.0 - root10 - a) / 18.0, (620.0 - w) / 3720.0);
  } else {
    add_orbit3(rule, 0.249286745170910, 0.116786275726379);
    add_orbit3(rule, 0.063089014491502, 0.050844906370207);
    add_orbit6(rule, 0.053145049844817, 0.310352451033784, 0.082851075618374);
  }
  normalise(rule);
  return rule;
}

Rule graded_rule(int order) {
  std::vector<double> nodes, weights;
  gauss_legendre(order, nodes, weights);
  Rule rule;
  for (int corner = 0; corner < 3; ++corner) {
    for (int i = 0; i < order; ++i) {
      const double rest = 1.0 - nodes[i];
      const double s = 1.0 - rest * rest * rest;
      const double ds = 3.0 * rest * rest * weights[i];
      for (int j = 0; j < order; ++j) {
        const double e = nodes[j];
        const double t = e * e * e * (10.0 - 15.0 * e + 6.0 * e * e);
        const double dt = 30.0 * e * e * (1.0 - e) * (1.0 - e) * weights[j];
        // c + s [(1-t)(a - c) + t (b - c)] in barycentric coordinates, a and b being this corner and the
        // next.
        double at[3] = {(1.0 - s) / 3.0, (1.0 - s) / 3.0, (1.0 - s) / 3.0};
        at[corner] += s * (1.0 - t);
        at[(corner + 1) % 3] += s * t;
        rule.push_back({at[0], at[1], 2.0 / 3.0 * s * ds * dt});
      }
    }
  }
  normalise(rule);
  return rule;
}

Rule far_rule(const Quadrature& quadrature) { return symmetric_rule(quadrature.far_points); }

Rule near_rule(const Quadrature& quadrature) {
  return quadrature.near_graded_order > 0 ? graded_rule(quadrature.near_graded_order)
                                          : symmetric_rule(quadrature.near_points);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
