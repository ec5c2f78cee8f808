// What a colour does at given pressures, contact and friction included: equations (7) to (9) of
// doc/solver.md.

// The way s over the surface beyond sticking: within the plane, (A + tau) s = -shear with A the tangential
// part of H, and tau |s| = mu (lambda_n + adhesion), lambda_n = press + n . H s. Were A a multiple a of one,
// tau would be a r/(|shear| - r); the a of the last guess makes that converge in a few rounds.
template <class T>
SOFTPOINT_INLINE Pack3<T> slide(const Sym3<T>& h, const Pack3<T>& n, const Pack3<T>& shear, Pack<T> press,
                                Pack<T> mu, Pack<T> adhesion) {
  const Pack<T> one = splat(T(1));
  // A right-handed frame about n, without a branch.
  const Pack<T> sign = n.z < T(0) ? -one : one;
  const Pack<T> f = -one / (sign + n.z), g = n.x * n.y * f;
  const Pack3<T> t = {one + sign * n.x * n.x * f, sign * g, -sign * n.x};
  const Pack3<T> u = {g, sign + n.y * n.y * f, -n.y};
  const Pack3<T> ht = times(h, t), hu = times(h, u);
  const Pack<T> att = dot(t, ht), auu = dot(u, hu), atu = dot(t, hu), ct = dot(n, ht), cu = dot(n, hu);
  const Pack<T> bt = -dot(t, shear), bu = -dot(u, shear);
  const Pack<T> size = sqrt(bt * bt + bu * bu) + std_tiny<T>();
  Pack<T> st{}, su{}, tau{};
  for (int round = 0; round < 6; ++round) {
    const Pack<T> p = att + tau, q = auu + tau;
    const Pack<T> inverse_det = one / (p * q - atu * atu);
    st = (q * bt - atu * bu) * inverse_det;
    su = (p * bu - atu * bt) * inverse_det;
    if (round == 5) break;
    const Pack<T> r = mu * max0<T>(press + ct * st + cu * su + adhesion);
    const Pack<T> a = size * inverse_root(st * st + su * su + std_tiny<T>()) - tau;
    const Pack<T> left = size - r;
    const Pack<T> least = T(1e-6) * size;
    tau = max0<T>(a * r) / (left > least ? left : least);
  }
  return {st * t.x + su * u.x, st * t.y + su * u.y, st * t.z + su * u.z};
}

// Exact Signorini-Coulomb: stick where the surface carries the point, else slide with mu lambda_n. `dx` is
// the move without contact; overwritten where the plane is crossed. Returns 0, 1 (sticks) or 2 (slides);
// force to `force`.
template <class T>
SOFTPOINT_INLINE Pack<T> contact(const SweepData<T>& d, long at, Pack3<T>& dx, Pack3<T>& force) {
  const Pack3<T> n = load3(d.nx, d.ny, d.nz, at);
  const Pack<T> level = load(d.level + at);
  const Place<T> x = place(places_now(d), at);
  const Mask<T> crossed = dot(n, x.x + dx) < level;
  force = Pack3<T>{};
  if (!any<T>(crossed)) return Pack<T>{};
  const Sym3<T> h = {load(d.h + at),
                     load(d.h + d.slots + at),
                     load(d.h + 2 * d.slots + at),
                     load(d.h + 3 * d.slots + at),
                     load(d.h + 4 * d.slots + at),
                     load(d.h + 5 * d.slots + at)};
  // Carried along by the surface from where the small step began, and onto the plane.
  const Place<T> start = place(places_at_start(d), at);
  const Pack3<T> carried = load3(d.ux, d.uy, d.uz, at);
  const Pack3<T> held = madd<T>(level - dot(n, start.x + carried), n, (start - x) + carried);
  const Pack3<T> stick = times(h, held - dx);
  const Pack<T> mu = load(d.friction + at), adhesion = load(d.adhesion + at);
  const Pack<T> press = dot(n, stick);
  const Pack3<T> shear = madd<T>(-press, n, stick);
  const Pack<T> limit = mu * (press + adhesion);
  const Mask<T> sticks = (press >= T(0)) & (dot(shear, shear) <= limit * limit) & crossed;
  Pack3<T> moved = held, pushed = stick;
  if (any<T>(crossed & ~sticks)) {
    const Pack3<T> slip = slide(h, n, shear, press, mu, adhesion);
    const Pack3<T> slid = held + slip, total = stick + times(h, slip);
    moved = {select<T>(sticks, moved.x, slid.x), select<T>(sticks, moved.y, slid.y),
             select<T>(sticks, moved.z, slid.z)};
    pushed = {select<T>(sticks, pushed.x, total.x), select<T>(sticks, pushed.y, total.y),
              select<T>(sticks, pushed.z, total.z)};
  }
  const Pack<T> zero{};
  dx = {select<T>(crossed, moved.x, dx.x), select<T>(crossed, moved.y, dx.y),
        select<T>(crossed, moved.z, dx.z)};
  force = {select<T>(crossed, pushed.x, zero), select<T>(crossed, pushed.y, zero),
           select<T>(crossed, pushed.z, zero)};
  const Pack<T> one = splat(T(1)), two = splat(T(2));
  return select<T>(sticks, one, select<T>(crossed, two, zero));
}

template <class T>
int move_colour(const SweepData<T>& d, const ColourPlan& c, const double* gauges, PocketSums* sums) {
  int changes = 0;
  PocketTotals<T> totals{sums};
  for (long tile = 0; tile < c.tiles; ++tile) {
    for (int lane = 0; lane < kTile; lane += Of<T>::lanes) {
      const long at = c.first + tile * kTile + lane;
      const bool airy = gauges != nullptr && d.tile_pocket[at / kTile] != -1;
      const bool planes = d.tile_planes[at / kTile] != 0;
      const Pack3<T> a = load3(d.ax, d.ay, d.az, at);
      Pack3<T> dx = {-a.x, -a.y, -a.z};
      if (airy) dx = madd<T>(gauge_of(d, at, gauges), load3(d.bx, d.by, d.bz, at), dx);
      const Pack<T> free = load(d.free + at);
      if (planes) {
        const Pack<T> before = load(d.touch + at);
        Pack3<T> force;
        const Pack<T> after = free * contact(d, at, dx, force);
        store(d.touch + at, after);
        store3(d.cx, d.cy, d.cz, at, {free * force.x, free * force.y, free * force.z});
        if (airy) {
          const Mask<T> other = (before > T(0)) ^ (after > T(0));
          if (any<T>(other)) ++changes;
        }
      }
      dx = {free * dx.x, free * dx.y, free * dx.z};
      store3(d.dx, d.dy, d.dz, at, dx);
      if (!airy) continue;
      // Those that touch count as moved.
      const Pack3<T> v = load3(d.vx, d.vy, d.vz, at), b = load3(d.bx, d.by, d.bz, at);
      const Mask<T> on = load(d.touch + at) > T(0);
      const Pack<T> apart = select<T>(on, Pack<T>{}, free);
      const Pack<T> kept = select<T>(on, free, Pack<T>{});
      totals.add(d, at, apart * dot(v, b), apart * dot(v, a), kept * dot(v, dx));
    }
  }
  totals.flush();
  return changes;
}

// x += dx, without loss: Knuth's sum of two.
template <class T>
SOFTPOINT_INLINE void go(T* x, T* low, long at, Pack<T> dx) {
  const Pack<T> from = load(x + at);
  if constexpr (sizeof(T) == 4) {
    const Pack<T> by = load(low + at) + dx, to = from + by, taken = to - from;
    store(low + at, (from - (to - taken)) + (by - taken));
    store(x + at, to);
  } else {
    store(x + at, from + dx);
  }
}

template <class T>
double commit_colour(const SweepData<T>& d, const ColourPlan& c, bool air, double* change) {
  Pack<T> largest{};
  for (long tile = 0; tile < c.tiles; ++tile) {
    for (int lane = 0; lane < kTile; lane += Of<T>::lanes) {
      const long at = c.first + tile * kTile + lane;
      const Pack3<T> dx = load3(d.dx, d.dy, d.dz, at);
      go(d.x, d.lx, at, dx.x);
      go(d.y, d.ly, at, dx.y);
      go(d.z, d.lz, at, dx.z);
      const Pack<T> square = dot(dx, dx);
      largest = square > largest ? square : largest;
      if (!air || d.tile_pocket[at / kTile] == -1) continue;
      by_pocket(d, at / kTile, at, dot(load3(d.vx, d.vy, d.vz, at), dx),
                [change](int p, double s) { change[p] += s; });
    }
  }
  double out = 0;
  for (int i = 0; i < Of<T>::lanes; ++i) out = largest[i] > out ? static_cast<double>(largest[i]) : out;
  return out;
}
