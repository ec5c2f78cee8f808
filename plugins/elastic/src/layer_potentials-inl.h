// Closed-form integrals over triangles, equations (6) to (10) of doc/boundary_elements.md, for kLanes
// triangles at a time. Included by kernels-inl.h only.

struct Pack3 {
  Pack x, y, z;
};

SOFTPOINT_INLINE Pack3 load3(const double* fields, std::ptrdiff_t stride, int field) {
  return {load(fields + field * stride), load(fields + (field + 1) * stride),
          load(fields + (field + 2) * stride)};
}
SOFTPOINT_INLINE Pack dot(const Pack3& a, const Pack3& b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }

// What a point adds, times its weight.
struct PanelSums {
  Pack dl[3];         // d_k L_k
  Pack e1[3];         // R_k+1 - R_k
  Pack hl[3];         // h L_k
  Pack h_omega;       // h Omega
  Pack omega;         // Omega
  Pack phi_omega[2];  // phi_a(x0) Omega
};

SOFTPOINT_INLINE void add_point(const double* fields, std::ptrdiff_t stride, const double* point,
                                PanelSums& sum) {
  const Pack w = splat(point[3]);
  Pack3 r[3];
  Pack length[3];
  for (int k = 0; k < 3; ++k) {
    const Pack3 v = load3(fields, stride, kFieldVertex + 3 * k);
    r[k] = {v.x - point[0], v.y - point[1], v.z - point[2]};
    length[k] = sqrt(dot(r[k], r[k]));
  }
  const Pack h = dot(load3(fields, stride, kFieldNormal), r[0]);
  const Pack h2 = h * h;

  // (7): solid angle; the triple product r0.(r1 x r2) is 2 A h.
  const Pack y = load(fields + kFieldTwiceArea * stride) * h;
  Pack x = fma(dot(r[0], r[1]), length[2], length[0] * length[1] * length[2]);
  x = fma(dot(r[1], r[2]), length[0], x);
  x = fma(dot(r[2], r[0]), length[1], x);
  const Pack omega = w * 2.0 * angle(y, x);
  sum.omega += omega;
  sum.h_omega = fma(h, omega, sum.h_omega);
  // phi_0 vanishes at v1, phi_1 at v2.
  sum.phi_omega[0] -= dot(load3(fields, stride, kFieldGradient), r[1]) * omega;
  sum.phi_omega[1] -= dot(load3(fields, stride, kFieldGradient + 3), r[2]) * omega;

  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Pack d = dot(load3(fields, stride, kFieldConormal + 3 * k), r[k]);
    const Pack sa = dot(load3(fields, stride, kFieldTangent + 3 * k), r[k]);
    const Pack sb = sa + load(fields + (kFieldLength + k) * stride);
    // (6): the branch without cancellation.
    const auto ahead = sa >= 0.0;
    const auto behind = sb <= 0.0;
    const Pack q = fma(d, d, h2);
    const Pack forth = length[next] + sb;  // good unless sb < 0
    const Pack back = length[k] - sa;      // good unless sa > 0
    Pack num = ahead ? forth : (behind ? back : forth * back);
    Pack den = ahead ? length[k] + sa : (behind ? length[next] - sb : q);
    const auto usable = den > 1e-280;
    num = usable ? num : splat(1.0);
    den = usable ? den : splat(1.0);
    const Pack wl = w * log_ratio(num, den);
    sum.dl[k] = fma(d, wl, sum.dl[k]);
    sum.hl[k] = fma(h, wl, sum.hl[k]);
    sum.e1[k] = fma(w, length[next] - length[k], sum.e1[k]);
  }
}

void layer_potentials(const double* fields, std::ptrdiff_t stride, const double* points, int count,
                      double* out) {
  PanelSums sum = {};
  for (int i = 0; i < count; ++i) {
    add_point(fields, stride, points + 4 * i, sum);
  }

  // (8): int 1/R, and h P3.
  const Pack i1 = sum.dl[0] + sum.dl[1] + sum.dl[2] - sum.h_omega;
  store(out + kSingle * kLanes, i1);
  Pack3 m[3];
  Pack3 p = {};
  for (int k = 0; k < 3; ++k) {
    m[k] = load3(fields, stride, kFieldConormal + 3 * k);
    p.x -= m[k].x * sum.hl[k];
    p.y -= m[k].y * sum.hl[k];
    p.z -= m[k].z * sum.hl[k];
  }

  // (9): int r r^T / R^3.
  const Pack3 n = load3(fields, stride, kFieldNormal);
  const Pack nn = sum.h_omega - i1;
  Pack xx = i1 + n.x * n.x * nn + 2.0 * n.x * p.x;
  Pack yy = i1 + n.y * n.y * nn + 2.0 * n.y * p.y;
  Pack zz = i1 + n.z * n.z * nn + 2.0 * n.z * p.z;
  Pack xy = n.x * n.y * nn + n.x * p.y + p.x * n.y;
  Pack xz = n.x * n.z * nn + n.x * p.z + p.x * n.z;
  Pack yz = n.y * n.z * nn + n.y * p.z + p.y * n.z;
  for (int k = 0; k < 3; ++k) {
    const Pack3 t = load3(fields, stride, kFieldTangent + 3 * k);
    const Pack3 a = {sum.dl[k] * m[k].x + sum.e1[k] * t.x, sum.dl[k] * m[k].y + sum.e1[k] * t.y,
                     sum.dl[k] * m[k].z + sum.e1[k] * t.z};
    xx -= a.x * m[k].x;
    yy -= a.y * m[k].y;
    zz -= a.z * m[k].z;
    xy -= 0.5 * (a.x * m[k].y + a.y * m[k].x);
    xz -= 0.5 * (a.x * m[k].z + a.z * m[k].x);
    yz -= 0.5 * (a.y * m[k].z + a.z * m[k].y);
  }
  const Pack tensor[6] = {xx, yy, zz, xy, xz, yz};
  for (int k = 0; k < 6; ++k) {
    store(out + (kTensor + k) * kLanes, tensor[k]);
  }

  // (10): the double layer. The three shape functions add up to one.
  const Pack d0 = -sum.phi_omega[0] - dot(load3(fields, stride, kFieldGradient), p);
  const Pack d1 = -sum.phi_omega[1] - dot(load3(fields, stride, kFieldGradient + 3), p);
  store(out + kDouble * kLanes, d0);
  store(out + (kDouble + 1) * kLanes, d1);
  store(out + (kDouble + 2) * kLanes, -sum.omega - d0 - d1);
}
