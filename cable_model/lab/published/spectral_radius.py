"""Spectral radii of the generalized-alpha family over omega dt [Gobat 2002, figure 1]."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np

from cable_model.kernels.family import coefficients
from cable_model.lab.published.page import Page
from cable_model.parameters import INTEGRATORS

NAME = "figure_1_spectral_radii"
CHECKED = (0.01, 0.1, 1.0, 10.0, 1e4)  # omega dt at which the quadratic of lambda -1/2 is drawn as dots
MEMBERS = {
    "box method (lambda -1)": ("generalized-alpha", -1.0),
    "lambda -0.9 (default)": ("generalized-alpha", -0.9),
    "lambda -0.7": ("generalized-alpha", -0.7),
    "lambda -0.5": ("generalized-alpha", -0.5),
    "lambda 0": ("generalized-alpha", 0.0),
    "lambda 0.25": ("generalized-alpha", 0.25),
    "trapezoidal rule": ("trapezoidal", 0.0),
    "backward differences": ("backward-difference", 0.0),
    "Cornwell-Malkus, lambda -0.5": ("cornwell-malkus", -0.5),
    "WBZ, lambda -0.5": ("wbz", -0.5),
}


@dataclass(frozen=True)
class Radii:
    """Spectral radii (points,) of each member over omega dt, and those of lambda -1/2 by its quadratic at CHECKED."""

    omega_dt: np.ndarray
    of: dict[str, np.ndarray]
    checked: np.ndarray


def radius(integrator: str, lambda_infinity: float, omega_dt: np.ndarray) -> np.ndarray:
    """Largest eigenvalue by size, for each omega dt, of the matrix that takes (y, dt y') of y' + omega y = 0 over one step."""
    c = coefficients(INTEGRATORS.index(integrator), lambda_infinity)
    z = np.asarray(omega_dt, dtype=float)
    implicit = np.empty((len(z), 2, 2))
    explicit = np.empty((len(z), 2, 2))
    implicit[:, 0, 0], implicit[:, 0, 1], implicit[:, 1, 0], implicit[:, 1, 1] = z * (1.0 - c.alpha_k), 1.0 - c.alpha_m, 1.0, -c.gamma
    explicit[:, 0, 0], explicit[:, 0, 1], explicit[:, 1, 0], explicit[:, 1, 1] = -z * c.alpha_k, -c.alpha_m, 1.0, 1.0 - c.gamma
    return np.abs(np.linalg.eigvals(np.linalg.solve(implicit, explicit))).max(axis=1)


def by_quadratic(lam: float, omega_dt: float) -> float:
    """The same from eqs 19-21 inserted in eqs 17-18: (E-1)[(lam+3)E - (3 lam+1)]/(2(1-lam)) + omega dt (E-lam)^2/(1-lam)^2 = 0."""
    inertia = np.array([lam + 3.0, -(3.0 * lam + 1.0)]) / (2.0 * (1.0 - lam))
    stiffness = np.array([1.0, -2.0 * lam, lam * lam]) / (1.0 - lam) ** 2
    return float(np.abs(np.roots(np.polymul(inertia, [1.0, -1.0]) + omega_dt * stiffness)).max())


def measure(quick: bool = False, told: Callable[[str], None] | None = None) -> Radii:
    omega_dt = np.logspace(-2.0, 4.0, 61 if quick else 601)
    return Radii(
        omega_dt,
        {label: radius(*member, omega_dt) for label, member in MEMBERS.items()},
        np.array([by_quadratic(-0.5, z) for z in CHECKED]),
    )


def page(found: Radii) -> Page:
    figure, axis = plt.subplots(figsize=(9, 5.5))
    for k, (label, values) in enumerate(found.of.items()):
        thin = label.startswith(("Cornwell", "WBZ"))
        axis.plot(found.omega_dt, values, ":" if thin else "-", color=f"C{k}", linewidth=1.2 if thin else 1.8, label=label)
    axis.plot(CHECKED, found.checked, "ko", markersize=5, label="lambda -0.5 by its quadratic")
    for z, value in zip(CHECKED, found.checked, strict=True):
        axis.annotate(f"{value:.5g}", (z, value), fontsize=8, xytext=(4, -12), textcoords="offset points")
    axis.set(xscale="log", xlabel="omega dt", ylabel="spectral radius", ylim=(0.0, 1.05), title="Damping of one step")
    axis.grid(alpha=0.3)
    axis.legend(fontsize=8, loc="lower left")
    apart = np.abs(radius("generalized-alpha", -0.5, np.array(CHECKED)) - found.checked).max()
    low = {label: values[0] for label, values in found.of.items()}
    dots = ", ".join(f"{value:.5g}" for value in found.checked)
    caption = (
        "[Gobat 2002, figure 1], from the coefficients that the kernels use.  The box method keeps everything at 1; backward differences "
        f"and lambda 0 go to 0 at large omega dt, lambda -0.9, -0.7 and -0.5 to {found.of['lambda -0.9 (default)'][-1]:.3f}, "
        f"{found.of['lambda -0.7'][-1]:.3f} and {found.of['lambda -0.5'][-1]:.3f}.  Dots: lambda -0.5 by its quadratic at omega dt = "
        f"{', '.join(f'{z:g}' for z in CHECKED)}: {dots} (largest difference {apart:.0e}).  At omega dt = {found.omega_dt[0]:g} the exact "
        f"decay is {np.exp(-found.omega_dt[0]):.6f}: lambda -0.5 gives {low['lambda -0.5']:.6f}, backward differences "
        f"{low['backward differences']:.6f}."
    )
    rows = [[float(z), *(float(values[i]) for values in found.of.values())] for i, z in enumerate(found.omega_dt)]
    return Page(NAME, "Figure 1: spectral radii of the family", caption, figure, ("omega_dt", *found.of), rows)
