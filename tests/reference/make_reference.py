"""Reference values for the Xiao et al. (2023) space robot, computed with Pinocchio.

Independent of the project's own code: the momentum maps come from Pinocchio's
centroidal algorithms on a free-flyer model, the attitude from a 4th-order
Magnus integrator with 4000 steps. Run:

    pip install pin==4.1.0 numpy && python make_reference.py > xiao2023.json

Conventions: quaternion (w, x, y, z) rotates base
vectors into the inertial frame; base twist and momentum are in the base frame;
base origin = base centre of mass; units m, kg, rad, s.
"""
import json
import numpy as np
import pinocchio as pin

deg = np.pi / 180
ALPHA = np.array([90, 90, -90, 0, 90, 0]) * deg
PHI = np.array([0, 90, 0, -90, 0, 0]) * deg
MASS = [600, 6.3, 6.9, 8.9, 11, 4.7, 4.9]
IXX = [75, .004, .004, .46, .95, .003, .02]
IYY = [74, .006, .006, .47, .94, .005, .02]
IZZ = [74, .004, .008, .01, .008, .003, .015]
IXY = [.25, 0, -.001, 0, 0, 0, 0]
IXZ = [.32, 0, 0, 0, 0, 0, 0]
IYZ = [.19, 0, 0, -.03, -.02, 0, 0]
A = np.array([[0, 0, .065], [.03, 0, -.055], [0, .01, .325], [0, -.425, .13], [0, .01, -.05], [0, 0, .04]])
B = np.array([[-.35, -.35, .4], [0, 0, .05], [-.03, 0, -.06], [0, -.01, .45], [0, -.45, .11], [0, -.01, -.065], [0, 0, .075]])
QMIN = np.array([-165, -130, -140, -170, -300, -150]) * deg
QMAX = np.array([165, 250, 160, 170, 300, 150]) * deg
Q0 = np.array([10, 30, 45, -20, -25, 40]) * deg
QF = np.array([40, 60, 90, -10, -30, 60]) * deg
D1, D2 = (QMAX - QMIN) / 2, (QMAX + QMIN) / 2
PUBLISHED = np.array([-3.8208, 1.7764, -2.0585, 3.2927, 5.2949, 9.9397,
                      -1.1520, .8619, 1.2449, 1.0670, .4441, .8062]) * 1e-5
PUBLISHED_TF = 6.3304


def rx(t): c, s = np.cos(t), np.sin(t); return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
def ry(t): c, s = np.cos(t), np.sin(t); return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
def rz(t): c, s = np.cos(t), np.sin(t); return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def model():
    m = pin.Model()
    parent = m.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    def inertia(i): return np.array([[IXX[i], IXY[i], IXZ[i]], [IXY[i], IYY[i], IYZ[i]], [IXZ[i], IYZ[i], IZZ[i]]])
    m.appendBodyToJoint(parent, pin.Inertia(MASS[0], np.zeros(3), inertia(0)), pin.SE3.Identity())
    place = pin.SE3(np.eye(3), B[0])
    for i in range(6):
        joint = m.addJoint(parent, pin.JointModelRZ(), place, f"joint{i + 1}")
        m.appendBodyToJoint(joint, pin.Inertia(MASS[i + 1], A[i], inertia(i + 1)), pin.SE3.Identity())
        place = pin.SE3(rz(PHI[i]) @ rx(ALPHA[i]), A[i] + B[i + 1])
        parent = joint
    m.addFrame(pin.Frame("tool", parent, 0, place, pin.FrameType.OP_FRAME))
    return m, m.createData()


MODEL, DATA = model()


def at(theta):
    return np.concatenate([np.zeros(6), [1.0], theta])


def base_map(theta):
    """6x6 J_bm: joint rates -> base twist [v; w] (base frame), zero total momentum."""
    ag = pin.computeCentroidalMap(MODEL, DATA, at(theta))
    return -np.linalg.solve(ag[:, :6], ag[:, 6:])


def tool(theta):
    q = at(theta)
    pin.framesForwardKinematics(MODEL, DATA, q)
    frame = MODEL.getFrameId("tool")
    pose = DATA.oMf[frame].copy()
    jac = pin.computeFrameJacobian(MODEL, DATA, q, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    return pose, jac[:, 6:] + jac[:, :6] @ base_map(theta)


def phase(a6, a7):
    """Coefficients of the phase polynomial in normalised time tau = t / t_f (eq. 24)."""
    s0, sf = np.arcsin((Q0 - D2) / D1), np.arcsin((QF - D2) / D1)
    d = sf - s0
    c = np.zeros((8, 6))
    c[0], c[3], c[4], c[5] = s0, 10 * d - a6 - 3 * a7, -15 * d + 3 * a6 + 8 * a7, 6 * d - 3 * a6 - 6 * a7
    c[6], c[7] = a6, a7
    return c


def joints(a6, a7, tf, tau):
    """Joint angle, rate, acceleration, jerk (eqs. 11-14, corrected) at normalised times tau."""
    p = np.polynomial.polynomial
    c = phase(a6, a7)
    s, s1, s2, s3 = (p.polyval(tau, p.polyder(c, k)) / tf**k for k in range(4))
    sin, cos, d = np.sin(s), np.cos(s), D1[:, None]
    return (d * sin + D2[:, None], d * cos * s1, d * (-sin * s1**2 + cos * s2),
            d * (-cos * s1**3 - 3 * sin * s1 * s2 + cos * s3))


def qmul(a, b):
    return np.concatenate([[a[0] * b[0] - a[1:] @ b[1:]], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])])


def final_attitude(a6, a7, start, steps=4000):
    """Base quaternion at tau = 1, 4th-order Magnus (body frame)."""
    q, h, s = start.copy(), 1 / steps, np.sqrt(3) / 6
    for k in range(steps):
        w = []
        for c in (0.5 - s, 0.5 + s):
            th, dth, _, _ = joints(a6, a7, 1.0, np.array([(k + c) * h]))
            w.append(base_map(th[:, 0])[3:] @ dth[:, 0])
        v = h / 2 * (w[0] + w[1]) + np.sqrt(3) / 12 * h * h * np.cross(w[0], w[1])
        n = np.linalg.norm(v)
        q = qmul(q, np.concatenate([[np.cos(n / 2)], np.sin(n / 2) / n * v if n > 1e-14 else v / 2]))
    return q / np.linalg.norm(q)


def main():
    rng = np.random.default_rng(2023)
    out = {"source": "pinocchio " + pin.__version__, "kinematics": [], "attitude": []}
    for _ in range(5):
        theta = rng.uniform(QMIN, QMAX)
        pose, jg = tool(theta)
        out["kinematics"].append({"theta": theta.tolist(), "tool_position": pose.translation.tolist(),
                                  "tool_rotation": pose.rotation.tolist(), "base_map": base_map(theta).tolist(),
                                  "generalised_jacobian": jg.tolist()})
    start = pin.Quaternion(rz(6 * deg) @ ry(15 * deg) @ rx(7 * deg))
    start = np.array([start.w, start.x, start.y, start.z])
    out["start_quaternion"] = start.tolist()
    cases = [("published", PUBLISHED[:6] * PUBLISHED_TF**6, PUBLISHED[6:] * PUBLISHED_TF**7)]
    for k in range(3):
        bump, skew = rng.normal(size=6) * 0.4, rng.normal(size=6) * 0.2
        a7 = -256 * skew
        cases.append((f"random{k}", -64 * bump - 3.5 * a7, a7))
    tau = np.linspace(0, 1, 20001)
    for name, a6, a7 in cases:
        q = final_attitude(a6, a7, start)
        _, v, a, j = joints(a6, a7, 1.0, tau)
        out["attitude"].append({"name": name, "A6": a6.tolist(), "A7": a7.tolist(), "final_quaternion": q.tolist(),
                                "residual_deg": float(2 * np.arcsin(np.linalg.norm(q[1:])) / deg),
                                "peak_rate_times_tf": np.abs(v).max(1).tolist(),
                                "peak_acceleration_times_tf2": np.abs(a).max(1).tolist(),
                                "peak_jerk_times_tf3": np.abs(j).max(1).tolist()})
    print(json.dumps(out, indent=1))


if __name__ == "__main__":
    main()
