// What pushes points at given pressures: what the coarse correction goes by. Equation (12) of doc/solver.md.

// What pushes the lanes at `at` at the pressures given, contact left out: minus the gradient.
template <class T>
SOFTPOINT_INLINE Pack3<T> push_of(const SweepData<T>& d, const ColourPlan& c, const double* gauges, long tile,
                                  int lane, long at) {
  Pack3<T> arms[kMaxRing];
  const Nodal<T> n = nodal(d, c, tile, lane, at, arms);
  const Pack3<T> push = {-n.g.x, -n.g.y, -n.g.z};
  if (gauges == nullptr || d.tile_pocket[at / kTile] == -1) return push;
  return madd<T>(gauge_of(d, at, gauges), volume_gradient(d, c, tile, lane, at, arms), push);
}

// Neither held nor stuck nor about to be; along the plane only where a point slides, against friction as it
// was.
template <class T>
void push_colour(const SweepData<T>& d, const ColourPlan& c, const double* gauges) {
  for (long tile = 0; tile < c.tiles; ++tile) {
    for (int lane = 0; lane < kTile; lane += Of<T>::lanes) {
      const long at = c.first + tile * kTile + lane;
      const Pack3<T> x = load3(d.x, d.y, d.z, at);
      Pack3<T> push = push_of(d, c, gauges, tile, lane, at);
      Pack<T> carried = load(d.free + at);
      if (d.tile_planes[at / kTile] != 0) {
        const Pack<T> touch = load(d.touch + at);
        const Pack3<T> n = load3(d.nx, d.ny, d.nz, at);
        const Mask<T> apart = touch == T(0), slides = touch == T(2);
        const Mask<T> leaves = (dot(n, x) > load(d.level + at)) | (dot(n, push) > T(0));
        carried = select<T>(slides | (apart & leaves), carried, Pack<T>{});
        const Pack<T> sliding = select<T>(slides, splat(T(1)), Pack<T>{});
        push = madd<T>(sliding, load3(d.cx, d.cy, d.cz, at), push);
        push = madd<T>(-sliding * dot(n, push), n, push);
      }
      store(d.carried + at, carried);
      store3(d.bx, d.by, d.bz, at, {carried * push.x, carried * push.y, carried * push.z});
    }
  }
}

// Of a point that slides: as large as it was, against its way over the surface by now.
template <class T>
SOFTPOINT_INLINE Pack3<T> friction_now(const SweepData<T>& d, long at) {
  const Pack3<T> n = load3(d.nx, d.ny, d.nz, at), force = load3(d.cx, d.cy, d.cz, at);
  const Pack3<T> drag = madd<T>(-dot(n, force), n, force);
  Pack3<T> way = (place(places_now(d), at) - place(places_at_start(d), at)) - load3(d.ux, d.uy, d.uz, at);
  way = madd<T>(-dot(n, way), n, way);
  const Pack<T> pull = -sqrt(dot(drag, drag)) * inverse_root(dot(way, way) + std_tiny<T>());
  return {pull * way.x, pull * way.y, pull * way.z};
}

template <class T>
double push_along_colour(const SweepData<T>& d, const ColourPlan& c, const double* gauges) {
  double total = 0;
  for (long tile = 0; tile < c.tiles; ++tile) {
    Pack<T> along{};
    for (int lane = 0; lane < kTile; lane += Of<T>::lanes) {
      const long at = c.first + tile * kTile + lane;
      Pack3<T> push = push_of(d, c, gauges, tile, lane, at);
      if (d.tile_planes[at / kTile] != 0) {
        const Pack<T> sliding = select<T>(load(d.touch + at) == T(2), splat(T(1)), Pack<T>{});
        push = madd<T>(sliding, friction_now(d, at), push);
      }
      along = along + dot(push, load3(d.dx, d.dy, d.dz, at));
    }
    total += sum<T>(along);
  }
  return total;
}
