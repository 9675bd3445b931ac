#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""SANDI by conceg fit against AMICO 2.1.1: signals of its GPD sphere, stick and ball, and a fit by SciPy of a model that is made of
them, with noise, at two timings.  amico_fit.py BIN"""
import csv
import pathlib
import subprocess
import sys
import tempfile

import amico
import numpy as np
from amico.synthesis import Ball, SphereGPD, Stick
from scipy.optimize import brentq, least_squares

GAMMA = 2.675987e8  # rad/s/T, AMICO's: b = (gamma G delta)^2 (Delta - delta / 3) follows from G, so it must be the same
failed = checks = 0


def check(what, difference, allowed):
    global failed, checks
    checks += 1
    ok = difference <= allowed
    failed += not ok
    print(f"{'' if ok else 'FAILED: '}{what}: {difference:.3g} (allowed {allowed:g})")


def directions(n):
    """n points spread over a half sphere by the golden angle."""
    k = np.arange(n) + 0.5
    z, angle = k / n, np.pi * (1 + 5**0.5) * k
    return np.stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z], axis=1)


def scheme(folder, bs, small, big, dirs):
    """A STEJSKALTANNER scheme of AMICO; b in ms/um^2, times in ms."""
    path = folder / "scheme"
    with open(path, "w") as out:
        out.write("VERSION: STEJSKALTANNER\n")
        for b in bs:
            g = np.sqrt(b * 1e9 / ((big - small / 3) * 1e-3)) / (GAMMA * small * 1e-3)
            for d in dirs:
                d = d if b > 0 else np.zeros(3)
                out.write(f"{d[0]:.17g} {d[1]:.17g} {d[2]:.17g} {g:.17g} {big * 1e-3:.17g} {small * 1e-3:.17g} {(big + small) * 1e-3:.17g}\n")
    return amico.scheme.Scheme(str(path))


class Kernels:
    """Direction averages of AMICO's compartments on one scheme."""

    def __init__(self, folder, bs, small, big, n):
        one, many = (scheme(folder, bs, small, big, directions(k)) for k in (1, n))
        self.n, self.ball_, self.stick_, self.sphere_ = n, Ball(one), Stick(many), SphereGPD(one)

    # AMICO takes mm^2/s and m.
    def ball(self, d):
        return np.asarray(self.ball_.get_signal(d * 1e-3))

    def stick(self, d):
        return np.asarray(self.stick_.get_signal(d * 1e-3)).reshape(-1, self.n).mean(axis=1)

    def sphere(self, d, r):
        return np.asarray(self.sphere_.get_signal(d * 1e-3, r * 1e-6))

    def model(self, f_e, g, r, d_in, d_e):
        return f_e * self.ball(d_e) + (1 - f_e) * (g * self.sphere(3.0, r) + (1 - g) * self.stick(d_in))


def conceg(programs, folder, bs, signal, small, big, name):
    rows = "\n".join(f"{name},{b:.17g},{s:.17g}" for b, s in zip(bs, signal))
    (folder / "signals.csv").write_text("compartment,b,signal\n" + rows + "\n")
    subprocess.run([programs / "conceg", "import", "signal", folder / "signals.csv", f"--pulse-duration-ms={small}",
                    f"--pulse-separation-ms={big}", "-o", folder / "signals.cgx", "-q"], check=True)
    subprocess.run([programs / "conceg", "fit", folder / "signals.cgx", "-q", "--csv", folder / "tables", "-o", folder / "fitted.cgx"], check=True)
    with open(folder / "tables/sandi.csv", newline="") as table:
        return next(csv.DictReader(table))


def by_scipy(kernels, signal, full):
    """The best of several starts, bounds as the defaults of conceg fit."""
    low, high = [0, 0, 1, 0.1, 0.1], [1, 1, 15, 3, 3]
    if not full:
        low[0], high[0], low[4], high[4] = -1e-12, 1e-12, 1 - 1e-9, 1 + 1e-9
    best = None
    for f_e, g, r, d_in, d_e in [(0.3, 0.3, 6, 1.5, 1.0), (0.2, 0.5, 9, 2.5, 0.7), (0.4, 0.2, 4, 1.0, 1.5), (0.3, 0.3, 8, 2.0, 0.9)]:
        start = [f_e, g, r, d_in, d_e] if full else [0, g, r, d_in, 1]
        fit = least_squares(lambda p: kernels.model(*p) - signal, start, bounds=(low, high), x_scale=[0.1, 0.1, 1, 0.3, 0.3], xtol=1e-12, ftol=1e-13, gtol=1e-13, max_nfev=60)
        if best is None or fit.cost < best.cost:
            best = fit
    return best


def ordered(kernels, bs, values):
    """Sphere and ball in the order that conceg fit keeps: both decay as exp(-b D), and the sphere is the slower one."""
    f_e, g, r, d_in, d_e = values
    apparent = lambda radius: -np.log(kernels.sphere(3.0, radius)[1]) / bs[1]
    if apparent(r) <= d_e:
        return (1 - f_e) * g, r, d_in
    return f_e, brentq(lambda radius: apparent(radius) - d_e, 1, 15), d_in


def main():
    programs = pathlib.Path(sys.argv[1]).resolve()
    random = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        # Signals of the compartments: what conceg fit makes of them has no residual only if its kernels are the same.
        for small, big in ((5, 20), (3, 11)):
            bs = [0, 0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15]
            kernels = Kernels(folder, bs, small, big, 200)
            row = conceg(programs, folder, bs, kernels.model(0, 0.35, 6.5, 1.9, 1), small, big, "intra")
            check(f"delta {small}, Delta {big}: reduced, f_soma", abs(float(row["f_soma"]) - 0.35), 2e-5)
            check("  radius, um", abs(float(row["radius_um"]) - 6.5), 2e-4)
            check("  residual", float(row["rms"]), 1e-6)
            row = conceg(programs, folder, bs, kernels.model(0.3, 0.3, 7, 2, 1), small, big, "all")
            check("  full, f_extracellular", abs(float(row["f_extracellular"]) - 0.3), 2e-4)
            check("  radius, um", abs(float(row["radius_um"]) - 7), 1e-3)
            for full, noise in ((False, 1e-3), (True, 1e-4)):
                signal = kernels.model(0.3 if full else 0, 0.3, 7, 2, 1) + noise * random.standard_normal(len(bs))
                signal[0] = 1.0
                theirs, ours = by_scipy(kernels, signal, full), conceg(programs, folder, bs, signal, small, big, "all" if full else "intra")
                x = theirs.x
                f_s, r, d_in = ordered(kernels, bs, x) if full else (x[1], x[2], x[3])
                check(f"delta {small}, Delta {big}: {'full' if full else 'reduced'}, noise {noise:g}: beside SciPy on AMICO's kernels, f_soma",
                      abs(f_s - float(ours["f_soma"])), 2e-4)
                check("  radius, um", abs(r - float(ours["radius_um"])), 2e-3)
                check("  neurite diffusivity", abs(d_in - float(ours["neurite_diffusivity_um2/ms"])), 1e-3)
    print(f"{checks} checks, {failed} failed")
    return 1 if failed or not checks else 0


sys.exit(main())
