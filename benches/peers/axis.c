/* The base model of an axis, for the peers: nothing here is shared with servoscope.
 *
 *     tau = A(s) u,   v' = -a v + K (tau - f),   f set-valued dry friction, sticking at v = 0
 *
 * Between two events the motion is known in closed form; events (v reaches 0, the torque leaves the
 * friction levels) are bracketed on a grid and located by Newton's method. For a cosine, time is the
 * angle x = w t + arg A(jw), so that the torque is M cos x. */
#include <complex.h>
#include <math.h>

#define GRID 32        /* steps a period, in which events are bracketed */
#define MOST_PARTS 64  /* phases of a period */
#define HIGHEST 15     /* highest harmonic */

static const double TURN = 6.283185307179586476925;

/* What an axis does while it slides: v(x) = P cos(x - psi) + B + C exp(-alpha (x - x0)). */
typedef struct {
    double torque, plus, minus; /* amplitude of the torque, friction levels */
    double alpha, gain;         /* a/w, K/w */
    double p, psi;
    double release_plus, release_minus; /* angles in [0, TURN) at which it breaks away */
} Cosine;

/* A phase: sliding forwards (1), backwards (-1), or at rest (0). */
typedef struct {
    double from, to;
    int direction;
} Part;

typedef struct {
    double b, c, x0, alpha, p, psi;
} Slide;

static double velocity(const Slide *s, double x, double *slope) {
    double e = s->c * exp(-s->alpha * (x - s->x0));
    double cosine = cos(x - s->psi), sine = sin(x - s->psi);
    *slope = -s->p * sine - s->alpha * e;
    return s->p * cosine + s->b + e;
}

/* The zero in [l, r], where sign * v is positive at l and not at r. */
static double zero_between(const Slide *s, double sign, double l, double r) {
    double x = 0.5 * (l + r);
    for (int i = 0; i < 80; i++) {
        double slope, v = velocity(s, x, &slope);
        if (sign * v > 0) l = x; else r = x;
        double next = x - v / slope;
        if (!(next > l && next < r)) next = 0.5 * (l + r);
        if (fabs(next - x) < 1e-14 * (1 + fabs(x))) return next;
        x = next;
    }
    return x;
}

/* Whether v dips to zero between l and r, where it falls at l and rises at r; then r is set to a
 * point beyond the first zero. */
static int dips(const Slide *s, double sign, double l, double *r) {
    double low = l, high = *r;
    for (int i = 0; i < 50; i++) {
        double x = 0.5 * (low + high), slope;
        if (sign * velocity(s, x, &slope) <= 0) { *r = x; return 1; }
        if (sign * slope < 0) low = x; else high = x;
    }
    return 0;
}

/* The angle at which a slide from (x0, v0) comes to v = 0; `end` if it does not before. */
static double end_of_slide(const Slide *s, double sign, double end) {
    const double h = TURN / GRID;
    double x = s->x0, left = x;
    int falls = 0;
    double e = s->c, q = exp(-s->alpha * h), turn_c = cos(h), turn_s = sin(h);
    double cosine = cos(x - s->psi), sine = sin(x - s->psi);
    for (int i = 0; left < end; i++) {
        double right = x + (i + 1) * h, c = cosine * turn_c - sine * turn_s;
        sine = sine * turn_c + cosine * turn_s;
        cosine = c;
        e *= q;
        double v = s->p * cosine + s->b + e, slope = -s->p * sine - s->alpha * e;
        if (right > end) {
            right = end;
            v = velocity(s, right, &slope);
        }
        int crosses = sign * v <= 0;
        if (!crosses && falls && sign * slope > 0) crosses = dips(s, sign, left, &right);
        if (crosses) {
            double l = left, unused;
            if (i == 0) { /* It may have set off from v = 0 at `left` itself. */
                double step = right - left;
                for (int half = 0; half < 45; half++) {
                    step *= 0.5;
                    l = left + step;
                    if (sign * velocity(s, l, &unused) > 0) break;
                    right = l;
                }
            }
            return zero_between(s, sign, l, right);
        }
        falls = sign * slope < 0;
        left = right;
    }
    return end;
}

static double next_at(double angle, double x) {
    return angle + TURN * ceil((x - angle) / TURN);
}

/* One period from velocity v at x = 0. Returns the velocity at its end, and its derivative. */
static double period(const Cosine *m, double v, double *derivative, Part *parts, int *count) {
    double x = 0, d = 1;
    int direction = v > 0 ? 1 : v < 0 ? -1 : 0, n = 0;
    if (direction == 0) {
        if (m->torque > m->plus) direction = 1;
    }
    while (x < TURN && n < MOST_PARTS) {
        double from = x;
        Part *part = &parts[n++];
        part->direction = direction;
        if (direction == 0) {
            double forwards = m->torque > m->plus ? next_at(m->release_plus, x) : TURN;
            double backwards = m->torque > m->minus ? next_at(m->release_minus, x) : TURN;
            x = fmin(fmin(forwards, backwards), TURN);
            direction = forwards < backwards ? 1 : -1;
            v = d = 0;
        } else {
            double level = direction > 0 ? m->plus : -m->minus;
            double b = -m->gain * level / m->alpha;
            Slide s = {b, v - b - m->p * cos(x - m->psi), x, m->alpha, m->p, m->psi};
            x = end_of_slide(&s, direction, TURN);
            d *= exp(-m->alpha * (x - from));
            if (x < TURN) {
                double torque = m->torque * cos(x), before = torque - level;
                int to = torque > m->plus ? 1 : torque < -m->minus ? -1 : 0;
                /* Rounding may put the torque on the side that it came from. */
                if (to == direction) to = 0;
                d *= to == 0 ? 0 : (torque - (to > 0 ? m->plus : -m->minus)) / before;
                direction = to;
                v = 0;
            } else {
                double slope;
                v = velocity(&s, TURN, &slope);
            }
        }
        part->from = from;
        part->to = x;
    }
    *count = n;
    *derivative = d;
    return v;
}

/* Harmonics 0 to highest of v for u = m cos(w t). actuator: order, then its parameters. */
static int harmonics(double a, double k, double plus, double minus, int order,
                     const double *actuator, double m, double w, int highest,
                     double complex *out) {
    double complex through = 1;
    if (order == 1) through = actuator[0] / (actuator[0] + I * w);
    if (order == 2) {
        double wn = actuator[0], zeta = actuator[1];
        through = wn * wn / (wn * wn - w * w + 2 * I * zeta * wn * w);
    }
    Cosine motion = {.torque = m * cabs(through), .plus = plus, .minus = minus,
                     .alpha = a / w, .gain = k / w};
    motion.p = k * motion.torque / hypot(a, w);
    motion.psi = atan2(w, a);
    if (motion.torque > plus) motion.release_plus = TURN - acos(plus / motion.torque);
    if (motion.torque > minus) motion.release_minus = acos(-minus / motion.torque);

    /* The velocity at the end of a period falls short of, or exceeds, that at its beginning;
     * the excess only falls with it, so Newton's method is kept in a bracket. */
    Part parts[MOST_PARTS];
    int count = 0;
    double limit = 1.01 * k * motion.torque / a, low = -limit, high = limit, v = 0;
    for (int i = 0;; i++) {
        if (i == 100) return 1;
        double d, excess = period(&motion, v, &d, parts, &count) - v;
        if (fabs(excess) <= 1e-13 * motion.p) break;
        if (excess > 0) low = v; else high = v;
        double next = v + excess / (1 - d);
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next == v) break;
        v = next;
    }

    /* (a + j k w) V_k = K (T_k - F_k), and friction is piecewise constant, or the torque. */
    double complex friction[HIGHEST + 1] = {0};
    for (int i = 0; i < count; i++) {
        double from = parts[i].from, to = parts[i].to;
        double complex e0 = cexp(-I * from), e1 = cexp(-I * to), p0 = 1, p1 = 1;
        double complex whole[HIGHEST + 2]; /* integral of exp(-j k x) */
        whole[0] = to - from;
        for (int h = 1; h <= highest + 1; h++) {
            p0 *= e0;
            p1 *= e1;
            whole[h] = (p1 - p0) * I / h;
        }
        for (int h = 0; h <= highest; h++) {
            if (parts[i].direction > 0) friction[h] += plus * whole[h];
            else if (parts[i].direction < 0) friction[h] -= minus * whole[h];
            else {
                double complex below = h > 0 ? whole[h - 1] : conj(whole[1]);
                friction[h] += 0.5 * motion.torque * (below + whole[h + 1]);
            }
        }
    }
    double complex shift = cexp(I * carg(through)), turn = 1;
    for (int h = 0; h <= highest; h++) {
        double complex torque = h == 1 ? motion.torque : 0;
        double complex f = friction[h] * (h == 0 ? 1 : 2) / TURN;
        out[h] = turn * k * (torque - f) / (a + I * (h * w));
        turn *= shift;
    }
    return 0;
}

/* Responses of a design of n points: re, im of harmonics 0 to highest, point by point.
 * axis: a, K, Fc+, Fc-, then the actuator's. Returns the number of points without a response. */
int design_response(const double *axis, int order, int n, const double *magnitude,
                    const double *omega, int highest, double *out) {
    int failed = 0;
    for (int i = 0; i < n; i++) {
        double complex response[HIGHEST + 1];
        failed += harmonics(axis[0], axis[1], axis[2], axis[3], order, axis + 4, magnitude[i],
                            omega[i], highest, response);
        for (int h = 0; h <= highest; h++) {
            out[2 * (i * (highest + 1) + h)] = creal(response[h]);
            out[2 * (i * (highest + 1) + h) + 1] = cimag(response[h]);
        }
    }
    return failed;
}

/* Residuals (simulated - measured)/std in the same order; im of harmonic 0 is left 0. Returns their
 * sum of squares. */
double design_residuals(const double *axis, int order, int n, const double *magnitude,
                        const double *omega, int highest, const double *measured, double std,
                        double *out) {
    double sum = 0;
    int size = 2 * n * (highest + 1);
    if (design_response(axis, order, n, magnitude, omega, highest, out)) return INFINITY;
    for (int i = 0; i < size; i++) {
        int imaginary_mean = i % (2 * (highest + 1)) == 1;
        out[i] = imaginary_mean ? 0 : (out[i] - measured[i]) / std;
        sum += out[i] * out[i];
    }
    return sum;
}

/* v at time t of a step in which the torque is u + ramp t, and the distance covered. */
static double ramp_velocity(double a, double k, double net, double ramp, double v, double t,
                            double *distance) {
    double slope = k * ramp / a, base = k * net / a - slope / a, c = v - base;
    double decay = expm1(-a * t);
    *distance = base * t + 0.5 * slope * t * t - c * decay / a;
    return base + slope * t + c * (decay + 1);
}

/* A motion under samples u of a force that goes straight between them, every dt seconds:
 * v' = -a v + K (u - f). Writes the n positions; starts at q[0] with velocity v. Returns the
 * velocity at the end. */
double motion(double a, double k, double plus, double minus, int n, double dt, const double *u,
              double v, double *q) {
    int direction = v > 0 ? 1 : v < 0 ? -1 : 0;
    for (int i = 0; i + 1 < n; i++) {
        double t = 0, ramp = (u[i + 1] - u[i]) / dt, way = 0;
        while (t < dt) {
            double force = u[i] + ramp * t, left = dt - t, part = left, moved = 0;
            if (direction == 0) {
                double limit = ramp > 0 ? plus : -minus;
                if (force > plus) direction = 1;
                else if (force < -minus) direction = -1;
                else if (ramp != 0 && (limit - force) / ramp < left) {
                    part = (limit - force) / ramp;
                    direction = ramp > 0 ? 1 : -1;
                } else break;
                if (part == left) part = 0;
            } else {
                double net = force - (direction > 0 ? plus : -minus);
                double end = ramp_velocity(a, k, net, ramp, v, left, &moved);
                if (direction * end <= 0) {
                    double low = 0, high = left, unused;
                    for (int half = 0; half < 60; half++) {
                        double middle = 0.5 * (low + high);
                        double there = ramp_velocity(a, k, net, ramp, v, middle, &unused);
                        if (direction * there > 0) low = middle; else high = middle;
                    }
                    part = high;
                    ramp_velocity(a, k, net, ramp, v, part, &moved);
                    end = 0;
                    double torque = force + ramp * part;
                    direction = torque > plus && direction < 0    ? 1
                                : torque < -minus && direction > 0 ? -1
                                                                   : 0;
                    if (part <= 0) part = 1e-12 * dt;
                }
                v = end;
            }
            way += moved;
            t += part;
        }
        q[i + 1] = q[i] + way;
    }
    return v;
}
