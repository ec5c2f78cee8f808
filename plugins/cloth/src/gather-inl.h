// Gradient and Hessian of each point of a colour: equations (2) to (5) of doc/solver.md.

// Where slot `at` of tile `tile` finds its neighbour.
template <class T>
SOFTPOINT_INLINE Pack3<T> neighbour(const T* x, const T* y, const T* z, const int* offset, const int* index,
                                    int count, int k, long tile, int lane, long at) {
  if (offset != nullptr) return load3(x, y, z, at + offset[k]);
  const int* p = index + (tile * count + k) * kTile + lane;
  return {gather(x, p), gather(y, p), gather(z, p)};
}

// Numbers that are each kept as two of type T, the second below the last digit of the first. Cloth at rest
// would creep if each small step rounded its places: a spring of 10 kN/m feels one unit in the last place of
// a few centimetres as half a point's weight. In double the first is enough.
template <class T>
struct Places {
  const T *x, *y, *z, *lx, *ly, *lz;
};
template <class T>
SOFTPOINT_INLINE Places<T> places_now(const SweepData<T>& d) {
  return {d.x, d.y, d.z, d.lx, d.ly, d.lz};
}
template <class T>
SOFTPOINT_INLINE Places<T> places_at_start(const SweepData<T>& d) {
  return {d.sx, d.sy, d.sz, d.rx, d.ry, d.rz};
}
template <class T>
struct Place {
  Pack3<T> x, low;
};
template <class T>
SOFTPOINT_INLINE Place<T> place(const Places<T>& p, long at) {
  if constexpr (sizeof(T) == 4) return {load3(p.x, p.y, p.z, at), load3(p.lx, p.ly, p.lz, at)};
  return {load3(p.x, p.y, p.z, at), Pack3<T>{}};
}
template <class T>
SOFTPOINT_INLINE Pack3<T> operator-(const Place<T>& a, const Place<T>& b) {
  if constexpr (sizeof(T) == 4) return (a.x - b.x) + (a.low - b.low);
  return a.x - b.x;
}

// From `from`, the place of slot `at`, to its neighbour's.
template <class T>
SOFTPOINT_INLINE Pack3<T> arm(const Places<T>& p, const Place<T>& from, const int* offset, const int* index,
                              int count, int k, long tile, int lane, long at) {
  Place<T> to;
  to.x = neighbour(p.x, p.y, p.z, offset, index, count, k, tile, lane, at);
  if constexpr (sizeof(T) == 4) to.low = neighbour(p.lx, p.ly, p.lz, offset, index, count, k, tile, lane, at);
  return to - from;
}

template <class T>
struct Nodal {
  Pack3<T> g;
  Sym3<T> h;
};

// Springs, dampers, bending and inertia of the lanes at `at`; arms to the neighbours into `arms`.
template <class T>
SOFTPOINT_INLINE Nodal<T> nodal(const SweepData<T>& d, const ColourPlan& c, long tile, int lane, long at,
                                Pack3<T>* arms) {
  const Pack<T> m = load(d.inertia + at);
  const Places<T> now = places_now(d);
  const Place<T> x = place(now, at);
  const Pack3<T> off = (x - place(places_at_start(d), at)) - load3(d.tx, d.ty, d.tz, at);
  Nodal<T> out;
  out.g = {m * off.x, m * off.y, m * off.z};
  Pack<T> xx = m, yy = m, zz = m, xy{}, xz{}, yz{};
  const Pack<T> compression = splat(d.compression);
  const T* spring = d.springs + c.spring_at + tile * c.ring * 4 * kTile + lane;
  for (int k = 0; k < c.ring; ++k, spring += 4 * kTile) {
    const Pack3<T> r = arm(now, x, c.offset, c.index, c.ring, k, tile, lane, at);
    arms[k] = r;
    const Pack<T> stiff = load(spring), rest = load(spring + kTile);
    const Pack<T> damper = load(spring + 2 * kTile), damped = load(spring + 3 * kTile);
    const Pack<T> square = dot(r, r) + std_tiny<T>();
    const Pack<T> inverse_length = inverse_root(square);
    const Pack<T> length = square * inverse_length;
    const Pack<T> longer = length - rest;
    const Pack<T> tangent = longer > T(0) ? stiff : stiff * compression;
    const Pack<T> elastic = tangent * longer;
    const Pack<T> tension = fma(damper, length, elastic - damped);
    const Pack<T> lateral = max0<T>(elastic) * inverse_length;
    const Pack3<T> n = {r.x * inverse_length, r.y * inverse_length, r.z * inverse_length};
    const Pack<T> along = tangent + damper - lateral;
    out.g = madd(-tension, n, out.g);
    const Pack<T> sx = along * n.x, sy = along * n.y, sz = along * n.z;
    xx = fma(sx, n.x, xx + lateral);
    yy = fma(sy, n.y, yy + lateral);
    zz = fma(sz, n.z, zz + lateral);
    xy = fma(sx, n.y, xy);
    xz = fma(sx, n.z, xz);
    yz = fma(sy, n.z, yz);
  }
  const T* bend = d.bend_weight + c.bend_at + tile * c.bends * kTile + lane;
  for (int k = 0; k < c.bends; ++k, bend += kTile) {
    const Pack3<T> r = arm(now, x, c.bend_offset, c.bend_index, c.bends, k, tile, lane, at);
    const Pack<T> w = load(bend);  // of B, whose rows sum to zero: g = sum w (x_j - x), H = -sum w
    out.g = madd(w, r, out.g);
    xx -= w, yy -= w, zz -= w;
  }
  out.h = {xx, yy, zz, xy, xz, yz};
  return out;
}

// dV/dx of the faces, times 1; equation (4). Relative arms lose no digits; rims add the rest.
template <class T>
SOFTPOINT_INLINE Pack3<T> volume_gradient(const SweepData<T>& d, const ColourPlan& c, long tile, int lane,
                                          long at, const Pack3<T>* arms) {
  Pack3<T> out{};
  const T* weight = d.face_weight + c.face_at + tile * c.faces * kTile + lane;
  for (int k = 0; k < c.faces; ++k, weight += kTile) {
    const Pack3<T>&p = arms[c.face_j[k]], &q = arms[c.face_k[k]];
    const Pack<T> w = load(weight);  // 1/6 or -1/6 in the pocket, else 0
    out.x = fma(w, fma(p.y, q.z, -(p.z * q.y)), out.x);
    out.y = fma(w, fma(p.z, q.x, -(p.x * q.z)), out.y);
    out.z = fma(w, fma(p.x, q.y, -(p.y * q.x)), out.z);
  }
  return out + load3(d.ex, d.ey, d.ez, at);
}

template <class T>
SOFTPOINT_INLINE Pack<T> gauge_of(const SweepData<T>& d, long at, const double* gauges) {
  const int pocket = d.tile_pocket[at / kTile];
  if (pocket == -1) return Pack<T>{};
  if (pocket >= 0) return splat(static_cast<T>(gauges[pocket]));
  Pack<T> out{};
  for (int i = 0; i < Of<T>::lanes; ++i) {
    const int p = d.slot_pocket[at + i];
    if (p >= 0) out[i] = static_cast<T>(gauges[p]);
  }
  return out;
}

// Adds the lanes of `values` to the pockets of a tile.
template <class T, class Add>
SOFTPOINT_INLINE void by_pocket(const SweepData<T>& d, long tile_index, long at, Pack<T> value, Add add) {
  const int pocket = d.tile_pocket[tile_index];
  if (pocket >= 0) {
    add(pocket, sum<T>(value));
  } else if (pocket == -2) {
    for (int i = 0; i < Of<T>::lanes; ++i) {
      if (d.slot_pocket[at + i] >= 0) add(d.slot_pocket[at + i], static_cast<double>(value[i]));
    }
  }
}

// Sums by pocket, flushed where the pocket changes: the lanes of a colour are added up but once.
template <class T>
struct PocketTotals {
  PocketSums* sums;
  int pocket = -1;
  Pack<T> stiff{}, lag{}, fixed{};

  SOFTPOINT_MEMBER void flush() {
    if (pocket >= 0) {
      sums[pocket].stiff += sum<T>(stiff);
      sums[pocket].lag += sum<T>(lag);
      sums[pocket].fixed += sum<T>(fixed);
    }
    stiff = lag = fixed = Pack<T>{};
  }
  SOFTPOINT_MEMBER void add(const SweepData<T>& d, long at, Pack<T> s, Pack<T> l, Pack<T> f) {
    const int own = d.tile_pocket[at / kTile];
    if (own == -2) {
      for (int i = 0; i < Of<T>::lanes; ++i) {
        const int p = d.slot_pocket[at + i];
        if (p < 0) continue;
        sums[p].stiff += static_cast<double>(s[i]);
        sums[p].lag += static_cast<double>(l[i]);
        sums[p].fixed += static_cast<double>(f[i]);
      }
      return;
    }
    if (own != pocket) flush();
    pocket = own;
    stiff += s;
    lag += l;
    fixed += f;
  }
};

template <class T>
void gather_colour(const SweepData<T>& d, const ColourPlan& c, bool air, PocketSums* sums) {
  Pack3<T> arms[kMaxRing];
  PocketTotals<T> totals{sums};
  for (long tile = 0; tile < c.tiles; ++tile) {
    for (int lane = 0; lane < kTile; lane += Of<T>::lanes) {
      const long at = c.first + tile * kTile + lane;
      const Nodal<T> n = nodal(d, c, tile, lane, at, arms);
      const Sym3<T> inv = inverse(n.h);
      const Pack3<T> a = times(inv, n.g);
      store3(d.gx, d.gy, d.gz, at, n.g);
      store3(d.ax, d.ay, d.az, at, a);
      const Pack<T>* h = &n.h.xx;
      for (int k = 0; k < 6; ++k) store(d.h + k * d.slots + at, h[k]);
      if (!air || d.tile_pocket[at / kTile] == -1) continue;
      const Pack3<T> v = volume_gradient(d, c, tile, lane, at, arms);
      const Pack3<T> b = times(inv, v);
      store3(d.vx, d.vy, d.vz, at, v);
      store3(d.bx, d.by, d.bz, at, b);
      const Pack<T> apart = load(d.touch + at) > T(0) ? splat(T(0)) : load(d.free + at);
      totals.add(d, at, apart * dot(v, b), apart * dot(v, a), Pack<T>{});
    }
  }
  totals.flush();
}

template <class T>
void measure_dampers(const SweepData<T>& d, const ColourPlan& c, T* springs) {
  for (long tile = 0; tile < c.tiles; ++tile) {
    for (int lane = 0; lane < kTile; lane += Of<T>::lanes) {
      const long at = c.first + tile * kTile + lane;
      const Places<T> start = places_at_start(d);
      const Place<T> x = place(start, at);
      T* spring = springs + c.spring_at + tile * c.ring * 4 * kTile + lane;
      for (int k = 0; k < c.ring; ++k, spring += 4 * kTile) {
        const Pack3<T> r = arm(start, x, c.offset, c.index, c.ring, k, tile, lane, at);
        const Pack<T> square = dot(r, r) + std_tiny<T>();
        store(spring + 3 * kTile, load(spring + 2 * kTile) * (square * inverse_root(square)));
      }
    }
  }
}

template <class T>
void volume_of_colour(const SweepData<T>& d, const ColourPlan& c, double* volumes) {
  Pack3<T> arms[kMaxRing];
  for (long tile = 0; tile < c.tiles; ++tile) {
    for (int lane = 0; lane < kTile; lane += Of<T>::lanes) {
      const long at = c.first + tile * kTile + lane;
      if (d.tile_pocket[at / kTile] == -1) continue;
      const Pack3<T> x = load3(d.x, d.y, d.z, at);
      for (int k = 0; k < c.ring; ++k) {
        arms[k] = neighbour(d.x, d.y, d.z, c.offset, c.index, c.ring, k, tile, lane, at);
      }
      Pack3<T> v{};
      const T* weight = d.face_weight + c.face_at + tile * c.faces * kTile + lane;
      for (int k = 0; k < c.faces; ++k, weight += kTile) {
        const Pack3<T> p = arms[c.face_j[k]] - x, q = arms[c.face_k[k]] - x;
        const Pack<T> w = load(weight);
        // det(x, x + p, x + q) = x . (p x q)
        v.x = fma(w, fma(p.y, q.z, -(p.z * q.y)), v.x);
        v.y = fma(w, fma(p.z, q.x, -(p.x * q.z)), v.y);
        v.z = fma(w, fma(p.x, q.y, -(p.y * q.x)), v.z);
      }
      by_pocket(d, at / kTile, at, dot(v, x), [volumes](int p, double s) { volumes[p] += s; });
    }
  }
}

template <class T>
double elastic_energy(const SweepData<T>& d, const ColourPlan& c) {
  double total = 0;
  for (long tile = 0; tile < c.tiles; ++tile) {
    Pack<T> energy{};
    for (int lane = 0; lane < kTile; lane += Of<T>::lanes) {
      const long at = c.first + tile * kTile + lane;
      const Places<T> now = places_now(d);
      const Place<T> x = place(now, at);
      const T* spring = d.springs + c.spring_at + tile * c.ring * 4 * kTile + lane;
      for (int k = 0; k < c.ring; ++k, spring += 4 * kTile) {
        const Pack3<T> r = arm(now, x, c.offset, c.index, c.ring, k, tile, lane, at);
        const Pack<T> square = dot(r, r) + std_tiny<T>();
        const Pack<T> longer = square * inverse_root(square) - load(spring + kTile);
        const Pack<T> stiff = load(spring);
        const Pack<T> tangent = longer > T(0) ? stiff : stiff * d.compression;
        energy = fma(tangent * longer, longer, energy);
      }
      const T* bend = d.bend_weight + c.bend_at + tile * c.bends * kTile + lane;
      for (int k = 0; k < c.bends; ++k, bend += kTile) {
        const Pack3<T> r = arm(now, x, c.bend_offset, c.bend_index, c.bends, k, tile, lane, at);
        energy = fma(-load(bend), dot(r, r), energy);  // 1/2 x^T B x = -1/4 sum w |x_j - x_i|^2, twice
      }
    }
    total += sum<T>(energy);
  }
  return 0.25 * total;
}
