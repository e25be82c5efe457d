// The base's rotation along joint paths, its rate found with Pinocchio in one of several ways.
//
// `rollout WAY PROBLEM MOTIONS`: for every line on standard input it goes through all motions and prints
// the seconds that a rollout took; at the end it prints, as JSON, the rotation at the end of each motion.
// `compare.py` writes both files; what stands where in them is said there. What is integrated, and how,
// is that of `src/attitude/rollout.rs`.

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "pinocchio/algorithm/centroidal.hpp"
#include "pinocchio/algorithm/crba.hpp"
#include "pinocchio/algorithm/kinematics.hpp"
#include "pinocchio/multibody.hpp"

namespace pin = pinocchio;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Quaternion = Eigen::Quaterniond;
using std::size_t;

constexpr size_t NODES = 6; // of a panel
constexpr size_t STEPS = 3; // of a panel
const double SQRT_15 = std::sqrt(15.0);

// ---- What is given.

struct Link {
  double offset, d, a, twist;  // DH row
  double lower, upper;         // range
  double start, goal;          // angles at both ends
  pin::Inertia inertia;        // in the proximal frame: turned by the angle, not by the offset
};

struct Problem {
  size_t steps, terms;
  pin::Inertia base;
  Vector3d mount;
  std::vector<Link> links;
};

double number(std::istream &in) {
  double value;
  if (!(in >> value)) {
    std::cerr << "a number is missing\n";
    std::exit(1);
  }
  return value;
}

Vector3d vector(std::istream &in) {
  const double x = number(in), y = number(in), z = number(in);
  return {x, y, z};
}

pin::Inertia inertia(std::istream &in) {
  const double mass = number(in);
  const Vector3d centre = vector(in), moments = vector(in), products = vector(in);
  Matrix3d about_centre;
  about_centre << moments.x(), products.x(), products.y(), //
      products.x(), moments.y(), products.z(),             //
      products.y(), products.z(), moments.z();
  return {mass, centre, pin::Symmetric3(about_centre)};
}

Problem problem(const char *path) {
  std::ifstream in(path);
  Problem given;
  given.steps = size_t(number(in));
  given.terms = size_t(number(in));
  given.links.resize(size_t(number(in)));
  given.base = inertia(in);
  given.mount = vector(in);
  for (Link &link : given.links) {
    for (double *value : {&link.offset, &link.d, &link.a, &link.twist, &link.lower, &link.upper,
                          &link.start, &link.goal})
      *value = number(in);
    link.inertia = inertia(in);
  }
  return given;
}

// ---- The base's rate at zero momentum, in several ways.

// Appends the arm to a model, each joint placed in the frame of the one before.
template <class Joint, class Model>
void append(Model &model, pin::JointIndex parent, const Problem &given) {
  pin::SE3 place(Matrix3d::Identity(), given.mount);
  for (const Link &link : given.links) {
    parent = model.addJoint(parent, Joint(), place, "joint" + std::to_string(model.njoints));
    model.appendBodyToJoint(parent, link.inertia, pin::SE3::Identity());
    const Matrix3d offset = Eigen::AngleAxisd(link.offset, Vector3d::UnitZ()).toRotationMatrix();
    const Matrix3d twist = Eigen::AngleAxisd(link.twist, Vector3d::UnitX()).toRotationMatrix();
    place = pin::SE3(offset * twist, offset * Vector3d(link.a, 0, link.d));
  }
}

pin::Model floating(const Problem &given) {
  pin::Model model;
  const auto base = model.addJoint(0, pin::JointModelFreeFlyer(), pin::SE3::Identity(), "base");
  model.appendBodyToJoint(base, given.base, pin::SE3::Identity());
  append<pin::JointModelRZ>(model, base, given);
  return model;
}

// Rate of a body with this inertia that cancels this angular momentum about its centre of mass.
inline Vector3d cancelling(const pin::Inertia &body, const Vector3d &momentum) {
  return -(body.inertia().matrix().inverse() * momentum);
}

// The base's rate where the whole, the arm moving and the base still, has this inertia and momentum,
// both about the base's origin.
inline Vector3d cancelling(const pin::Inertia &whole, const pin::Force &momentum) {
  return cancelling(whole, momentum.angular() - whole.lever().cross(momentum.linear()));
}

// The base a free joint, here at the origin and, where there are velocities, at rest.
struct Floating {
  explicit Floating(const Problem &given)
      : model(floating(given)), data(model), q(pin::neutral(model)), v(VectorXd::Zero(model.nv)) {}

  void place(const double *angles, const double *rates, size_t stride) {
    for (int j = 0; j < model.nv - 6; ++j) {
      q[7 + j] = angles[j * stride];
      v[6 + j] = rates[j * stride];
    }
  }

  static constexpr bool UNBOUNDED = false;
  pin::Model model;
  pin::Data data;
  VectorXd q, v;
};

struct CentroidalMap : Floating {
  using Floating::Floating;

  Vector3d rate() {
    const auto &map = pin::computeCentroidalMap(model, data, q);
    const Vector6d momentum = map.rightCols(model.nv - 6).lazyProduct(v.tail(model.nv - 6));
    const Matrix6d base = map.leftCols<6>();
    return -base.partialPivLu().solve(momentum).tail<3>();
  }
};

template <pin::Convention convention> struct Crba : Floating {
  using Floating::Floating;

  Vector3d rate() {
    pin::crba(model, data, q, convention);
    const int n = model.nv - 6;
    const Vector6d momentum = data.M.topRightCorner(6, n).lazyProduct(v.tail(n));
    const Matrix6d base = data.M.topLeftCorner<6, 6>();
    return -base.selfadjointView<Eigen::Upper>().llt().solve(momentum).tail<3>();
  }
};

struct Ccrba : Floating {
  using Floating::Floating;

  Vector3d rate() {
    pin::ccrba(model, data, q, v);
    return cancelling(data.Ig, data.hg.angular());
  }
};

struct Momentum : Floating {
  using Floating::Floating;

  Vector3d rate() {
    pin::forwardKinematics(model, data, q, v);
    pin::computeCentroidalMomentum(model, data);
    for (size_t i = 1; i < size_t(model.njoints); ++i)
      data.Ycrb[i] = model.inertias[i];
    for (size_t i = model.njoints - 1; i > 1; --i)
      data.Ycrb[i - 1] += data.liMi[i].act(data.Ycrb[i]);
    return cancelling(data.Ycrb[1], data.hg.angular());
  }
};

// Revolute joints only, so that visiting one is no choice among all that Pinocchio has.
template <typename Scalar, int Options> struct RevoluteOnly {
  using JointModelRZ = pin::JointModelRevoluteTpl<Scalar, Options, 2>;
  using JointModelRUBZ = pin::JointModelRevoluteUnboundedTpl<Scalar, Options, 2>;
  using JointModelMimic = pin::JointModelMimicTpl<Scalar, Options, RevoluteOnly>;
  using JointModelComposite = pin::JointModelCompositeTpl<Scalar, Options, RevoluteOnly>;
  using JointDataRZ = pin::JointDataRevoluteTpl<Scalar, Options, 2>;
  using JointDataRUBZ = pin::JointDataRevoluteUnboundedTpl<Scalar, Options, 2>;
  using JointDataMimic = pin::JointDataMimicTpl<Scalar, Options, RevoluteOnly>;
  using JointDataComposite = pin::JointDataCompositeTpl<Scalar, Options, RevoluteOnly>;
  // A model asks whether a joint mimics another, so there has to be such a kind.
  using JointModelVariant =
      boost::variant<JointModelRZ, JointModelRUBZ, boost::recursive_wrapper<JointModelMimic>>;
  using JointDataVariant =
      boost::variant<JointDataRZ, JointDataRUBZ, boost::recursive_wrapper<JointDataMimic>>;
};

// The arm alone, on a base that stands still; an unbounded joint is given its cosine and sine.
template <template <typename, int> class Joints, class Joint, bool unbounded> struct Fixed {
  explicit Fixed(const Problem &given)
      : model(arm(given)), data(model), base(given.base), q(VectorXd::Zero(model.nq)),
        v(VectorXd::Zero(model.nv)) {}

  static pin::ModelTpl<double, 0, Joints> arm(const Problem &given) {
    pin::ModelTpl<double, 0, Joints> model;
    append<Joint>(model, 0, given);
    return model;
  }

  void place(const double *angles, const double *rates, size_t stride) {
    for (int j = 0; j < model.nv; ++j) {
      q[j] = angles[j * stride];
      v[j] = rates[j * stride];
    }
  }

  void place(const double *sines, const double *cosines, const double *rates, size_t stride) {
    for (int j = 0; j < model.nv; ++j) {
      q[2 * j] = cosines[j * stride];
      q[2 * j + 1] = sines[j * stride];
      v[j] = rates[j * stride];
    }
  }

  static constexpr bool UNBOUNDED = unbounded;
  pin::ModelTpl<double, 0, Joints> model;
  pin::DataTpl<double, 0, Joints> data;
  pin::Inertia base;
  VectorXd q, v;
};

template <template <typename, int> class Joints, class Joint, bool unbounded = false>
struct FixedCcrba : Fixed<Joints, Joint, unbounded> {
  using Fixed<Joints, Joint, unbounded>::Fixed;

  Vector3d rate() {
    pin::ccrba(this->model, this->data, this->q, this->v);
    pin::Force momentum = this->data.hg;
    momentum.angular() += this->data.com[0].cross(momentum.linear());
    return cancelling(this->data.oYcrb[0] + this->base, momentum);
  }
};

// Forward kinematics, then inward what lies outward of each joint as one body, and its momentum.
template <template <typename, int> class Joints, class Joint, bool unbounded = false>
struct Inward : Fixed<Joints, Joint, unbounded> {
  using Fixed<Joints, Joint, unbounded>::Fixed;

  Vector3d rate() {
    pin::forwardKinematics(this->model, this->data, this->q);
    const size_t last = this->model.njoints - 1;
    pin::Inertia body = this->model.inertias[last];
    pin::Force momentum = pin::Force::Zero();
    for (size_t i = last;; --i) {
      // What a rate about z makes of the body.
      const double rate = this->v[i - 1];
      const Vector3d &centre = body.lever();
      const Vector3d linear = body.mass() * rate * Vector3d(-centre.y(), centre.x(), 0);
      const auto &entries = body.inertia().data(); // xx, xy, yy, xz, yz, zz
      momentum.linear() += linear;
      momentum.angular() +=
          rate * Vector3d(entries[3], entries[4], entries[5]) + centre.cross(linear);
      momentum = this->data.liMi[i].act(momentum);
      body = this->data.liMi[i].act(body);
      if (i == 1)
        break;
      body += this->model.inertias[i - 1];
    }
    body += this->base;
    return cancelling(body, momentum);
  }
};

// ---- The rollout.

// Step and bumps with their derivatives by τ.
struct Shape {
  double value, slope;
};

Shape step(double tau) {
  const double x = 2 * tau - 1, u = 1 - x * x;
  return {0.5 + x * (15 - x * x * (10 - 3 * x * x)) / 16, 2 * 15.0 / 16 * u * u};
}

// (1 − x²)³ P_k(x), P_k by the three-term recurrence of the orthonormal Gegenbauer polynomials.
std::vector<Shape> bumps(size_t terms, double tau) {
  const double x = 2 * tau - 1, u = 1 - x * x;
  const auto a = [](double k) {
    return std::sqrt(k * (k + 12) / (4 * (k + 6.5) * (k + 5.5)));
  };
  std::vector<Shape> polynomials, result;
  for (size_t k = 0; k < terms; ++k) {
    Shape p{1, 0};
    if (k > 0) {
      const Shape one = polynomials[k - 1], two = k > 1 ? polynomials[k - 2] : Shape{0, 0};
      const double back = k > 1 ? a(k - 1) : 0;
      p.value = (x * one.value - back * two.value) / a(k);
      p.slope = (one.value + x * one.slope - back * two.slope) / a(k);
    }
    polynomials.push_back(p);
    result.push_back({u * u * u * p.value, 2 * (u * u * u * p.slope - 6 * x * u * u * p.value)});
  }
  return result;
}

// All nodes of a panel, in its widths.
std::array<double, NODES> places() {
  const std::array<double, 3> half{0.03376524289842399, 0.16939530676686773, 0.38069040695840156};
  return {half[0], half[1], half[2], 1 - half[2], 1 - half[1], 1 - half[0]};
}

// Cosine and sine of a half angle and the sine by the angle, by the series where the angle is small.
Quaternion exponential(const Vector3d &v) {
  const double u = v.squaredNorm() / 4;
  double cosine, sine;
  if (u < 0.25) {
    cosine = sine = 0;
    static constexpr double COSINE[] = {1.,          -1. / 2,       1. / 24,
                                        -1. / 720,   1. / 40320,    -1. / 3628800,
                                        1. / 479001600, -1. / 87178291200};
    static constexpr double SINE[] = {1.,           -1. / 6,        1. / 120,
                                      -1. / 5040,   1. / 362880,    -1. / 39916800,
                                      1. / 6227020800, -1. / 1307674368000};
    for (int k = 7; k >= 0; --k) {
      cosine = cosine * u + COSINE[k];
      sine = sine * u + SINE[k];
    }
  } else {
    const double half = std::sqrt(u);
    cosine = std::cos(half);
    sine = std::sin(half) / half;
  }
  const Vector3d axis = v * (sine / 2);
  return {cosine, axis.x(), axis.y(), axis.z()};
}

// A step's rotation vector to sixth order.
Vector3d magnus(const Vector3d &a1, const Vector3d &a2, const Vector3d &a3) {
  const Vector3d c1 = a2.cross(a1);
  const Vector3d c2 = a1.cross(2 * a3 + c1) / 60;
  return a1 + a3 / 12 - (c1 - 20 * a1 - a3).cross(a2 + c2) / 240;
}

template <class Way> class Rollout {
public:
  explicit Rollout(const Problem &given)
      : way(given), terms(given.terms), joints(given.links.size()),
        panels((given.steps + STEPS - 1) / STEPS), nodes(panels * NODES), table(2 * (terms + 1)),
        phase(nodes), phase_rate(nodes), sine(nodes), cosine(nodes), angle(joints * nodes),
        sines(joints * nodes), cosines(joints * nodes), rates(joints * nodes) {
    for (size_t p = 0; p < panels; ++p)
      for (const double place : places()) {
        const double tau = (double(p) + place) / double(panels);
        size_t row = 0;
        const auto add = [&](const Shape &shape) {
          table[row++].push_back(shape.value);
          table[row++].push_back(shape.slope);
        };
        add(step(tau));
        for (const Shape &bump : bumps(terms, tau))
          add(bump);
      }
    for (const Link &link : given.links) {
      const double amplitude = (link.upper - link.lower) / 2, centre = (link.upper + link.lower) / 2;
      const double start = std::asin((link.start - centre) / amplitude);
      const double goal = std::asin((link.goal - centre) / amplitude);
      spans.push_back({amplitude, centre, start, goal - start});
    }
    const auto at = places();
    const double width = 1 / double(panels * STEPS);
    for (size_t s = 0; s < STEPS; ++s)
      for (size_t n = 0; n < NODES; ++n) {
        std::array<double, 3> w;
        for (int g = 0; g < 3; ++g) {
          const double place = (double(s) + 0.5 + (g - 1) * SQRT_15 / 10) / STEPS;
          w[g] = width;
          for (size_t m = 0; m < NODES; ++m)
            if (m != n)
              w[g] *= (place - at[m]) / (at[n] - at[m]);
        }
        moments[s](n, 0) = w[1];
        moments[s](n, 1) = (w[2] - w[0]) * SQRT_15 / 3;
        moments[s](n, 2) = (w[2] - 2 * w[1] + w[0]) * 10 / 3;
      }
  }

  Quaternion operator()(const double *coefficients) {
    drive(coefficients);
    Quaternion net = Quaternion::Identity();
    Eigen::Matrix<double, 3, NODES> panel;
    for (size_t p = 0; p < panels; ++p) {
      for (size_t n = 0; n < NODES; ++n) {
        const size_t node = p * NODES + n;
        if constexpr (Way::UNBOUNDED)
          way.place(&sines[node], &cosines[node], &rates[node], nodes);
        else
          way.place(&angle[node], &rates[node], nodes);
        panel.col(n) = way.rate();
      }
      for (const auto &step : moments) {
        const Matrix3d a = panel.lazyProduct(step);
        net = net * exponential(magnus(a.col(0), a.col(1), a.col(2)));
      }
    }
    return net;
  }

private:
  struct Span {
    double amplitude, centre, start, change;
  };

  // Every joint's angle and rate at every node.
  void drive(const double *coefficients) {
    for (size_t j = 0; j < joints; ++j) {
      const Span &span = spans[j];
      for (size_t i = 0; i < nodes; ++i) {
        phase[i] = span.start + span.change * table[0][i];
        phase_rate[i] = span.change * table[1][i];
      }
      for (size_t k = 0; k < terms; ++k) {
        const double c = coefficients[j * terms + k];
        const double *bump = table[2 * k + 2].data(), *slope = table[2 * k + 3].data();
        for (size_t i = 0; i < nodes; ++i) {
          phase[i] += c * bump[i];
          phase_rate[i] += c * slope[i];
        }
      }
      sines_and_cosines(phase.data(), sine.data(), cosine.data());
      for (size_t i = 0; i < nodes; ++i) {
        angle[j * nodes + i] = span.amplitude * sine[i] + span.centre;
        rates[j * nodes + i] = span.amplitude * cosine[i] * phase_rate[i];
      }
      if constexpr (Way::UNBOUNDED)
        sines_and_cosines(&angle[j * nodes], &sines[j * nodes], &cosines[j * nodes]);
    }
  }

  void sines_and_cosines(const double *from, double *sine, double *cosine) const {
#ifdef __FAST_MATH__
    // Apart, the compiler makes vectors of both.
    for (size_t i = 0; i < nodes; ++i)
      sine[i] = std::sin(from[i]);
    for (size_t i = 0; i < nodes; ++i)
      cosine[i] = std::cos(from[i]);
#else
    for (size_t i = 0; i < nodes; ++i)
      ::sincos(from[i], &sine[i], &cosine[i]);
#endif
  }

  Way way;
  size_t terms, joints, panels, nodes;
  std::vector<std::vector<double>> table; // step, its slope, first bump, its slope, …
  std::vector<Span> spans;
  std::array<Eigen::Matrix<double, NODES, 3>, STEPS> moments;
  std::vector<double> phase, phase_rate, sine, cosine;
  std::vector<double> angle, sines, cosines, rates; // joint by joint
};

template <class Way> int run(const Problem &given, const char *path) {
  std::ifstream in(path);
  const size_t count = size_t(number(in)), dimension = given.links.size() * given.terms;
  std::vector<double> motions(count * dimension);
  for (double &value : motions)
    value = number(in);
  Rollout<Way> rollout(given);
  std::vector<Quaternion> rotations(count);
  for (std::string line; std::getline(std::cin, line);) {
    const auto start = std::chrono::steady_clock::now();
    for (size_t i = 0; i < count; ++i)
      rotations[i] = rollout(&motions[i * dimension]);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    std::printf("%.17g\n", taken.count() / double(count));
    std::fflush(stdout);
  }
  for (size_t i = 0; i < count; ++i) {
    const Quaternion &q = rotations[i];
    std::printf("%s[%.17g, %.17g, %.17g, %.17g]", i ? ", " : "[", q.w(), q.x(), q.y(), q.z());
  }
  std::printf("]\n");
  return 0;
}

int main(int count, char **arguments) {
  if (count != 4) {
    std::cerr << "usage: rollout WAY PROBLEM MOTIONS\n";
    return 2;
  }
  const std::string way = arguments[1];
  const Problem given = problem(arguments[2]);
  const char *motions = arguments[3];
  using pin::JointCollectionDefaultTpl;
  using RZ = pin::JointModelRZ;
  using RUBZ = pin::JointModelRUBZ;
  if (way == "map")
    return run<CentroidalMap>(given, motions);
  if (way == "crba-local")
    return run<Crba<pin::Convention::LOCAL>>(given, motions);
  if (way == "crba-world")
    return run<Crba<pin::Convention::WORLD>>(given, motions);
  if (way == "ccrba")
    return run<Ccrba>(given, motions);
  if (way == "momentum")
    return run<Momentum>(given, motions);
  if (way == "fixed-ccrba")
    return run<FixedCcrba<JointCollectionDefaultTpl, RZ>>(given, motions);
  if (way == "inward")
    return run<Inward<JointCollectionDefaultTpl, RZ>>(given, motions);
  if (way == "inward-unbounded")
    return run<Inward<JointCollectionDefaultTpl, RUBZ, true>>(given, motions);
#ifndef PINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION
  if (way == "inward-only")
    return run<Inward<RevoluteOnly, RZ>>(given, motions);
  if (way == "inward-only-unbounded")
    return run<Inward<RevoluteOnly, RUBZ, true>>(given, motions);
#endif
  std::cerr << "no such way: " << way << "\n";
  return 2;
}
