"""What moves within a gear by itself."""

from typing import Any

import strainwave.variation


class Lumped:
    """
    A gear of one spring: nothing within it moves by itself.

    .. math:: T_{out} = T, \\qquad T_{in} = T\\,(1/i - e'(\\theta_{in}))

    with T_out the torque on the output, T_in the one that holds the input back, T the torque of the spring, its hysteresis
    and damping, i the ratio, e' the derivative of the kinematic error by the input angle. The wave generator turns with the
    input shaft. The ``stiffness`` of the gear is that of flexspline, mesh and bearings in series. Valid for what is slow
    against the vibration of the bodies within the gear, some 1e4 rad/s; Staged has these bodies.

    >>> import strainwave as sw
    >>> sw.Gear(stiffness=sw.stiffness.Linear(k=16e3)).structure
    Lumped()

    Parameters
    ----------

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, sections 1-4
    """

    def __init__(self) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /) -> Lumped:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'lumped'

    source: str = 'document R, sections 1-4'

    fields: tuple[dict[str, Any], ...]

class Staged:
    """
    A gear whose wave generator, flexspline and circular spline move by themselves.

    .. math:: T_{WG} = K_{WG}(\\theta_{in} - \\theta_{WG}) + c_{WG}(\\dot\\theta_{in} - \\dot\\theta_{WG}) =
              F_b \\left(r_g \\tan\\alpha_n + \\frac{d\\delta}{d\\theta_{WG}}\\right) + J_{WG}\\ddot\\theta_{WG}

    .. math:: F_b = K_b (\\delta + x_1 - x_2) + c_b(\\dot\\delta + \\dot x_1 - \\dot x_2) = F_m \\sin\\alpha_t + m_r \\ddot x_2

    .. math:: F_m = K_m \\mu + c_m \\dot\\mu, \\qquad \\mu = x_2 \\sin\\alpha_t - (y_1 + y_2) \\cos\\alpha_t

    .. math:: F_m r_g \\cos\\alpha_t = T_{FS}(y_1 / r_g) + J_{FS} \\ddot y_1 / r_g = J_{CS}\\ddot\\theta_{CS} + T_{CS}, \\qquad
              T_{CS} = K_{CS}(\\theta_{CS} - \\theta_{out}) + c_{CS}(\\dot\\theta_{CS} - \\dot\\theta_{out})

    with theta_in, theta_WG, theta_CS, theta_out the angles of input shaft, wave generator, circular spline and output
    shaft, x_2 the radial and y_1 the tangential displacement of the flexspline, r_g = pitch_radius, alpha_t =
    pressure_angle, x_1 = r_g tan(alpha_n) theta_WG, tan(alpha_n) = 1 / (i tan(alpha_t)), y_2 = r_g theta_CS, and i the
    ratio. K_WG, c_WG = coupling_stiffness, coupling_damping join the motor shaft to the wave generator; K_b, c_b are those
    of its bearing, K_m, c_m those of the mesh, K_CS, c_CS = circular_spline_stiffness, circular_spline_damping join the
    circular spline to the output shaft and its position sensor. The parts of the gear tell the rest: J_WG is its
    input_inertia, T_FS the torque of its stiffness, hysteresis and damping, delta = -e r_g / tan(alpha_t) its kinematic
    error as a radial displacement of the wave generator. m_r = radial_mass and J_FS = flexspline_inertia are those of the
    flexspline's toothed ring, J_CS = circular_spline_inertia.

    This is the gear with its flexspline fixed: its ratio is positive. Where the circular spline is fixed the ratio is
    negative, and the two exchange their places: T_CS holds the circular spline to the housing, and T_FS, over the twist of
    the flexspline against the output shaft, is the torque on it.

    Each stiffness may vary as the wave generator turns. The torque with which such a spring turns the wave generator is
    part of the model. Without load and misalignment theta_CS = theta_WG / i exactly.

    Document A prints the torque of F_b as F_b r_g sin(alpha_n) cos(alpha_n), by which the gear gives more power than it
    takes (E-A2), damps the mesh by a rate that is not that of its deformation (E-A3), gives the error the opposite sign of
    its own eq. (2) (E-A4), leaves out the reaction of the error (E-A5), and says three where there are four degrees of
    freedom (E-A6). Its x_1 is linear in theta_WG: the equations say nothing of the cyclic deformation of the flexspline.

    Friction of input and mesh acts on the motor shaft, as in a lumped gear. Both rings have one radius, as A has it: a turn
    of the held ring turns the output as far, where the ratio of the teeth would make it 1 percent more or less (E-A12).

    With the circular spline fixed, x_1, x_2 and the forces have the sign of the output's motion, y_1 is the twist of the
    flexspline against the output shaft times r_g, and y_2 counts against the output's sense.

    Output as A has it: ``bearing_displacement`` x_1, ``radial_displacement`` x_2, ``flexspline_displacement`` y_1,
    ``circular_spline_displacement`` y_2, ``bearing_force`` F_b, ``mesh_force`` F_m, ``wave_generator_torque`` T_WG,
    ``circular_spline_torque`` T_CS, and ``output_torque`` T = torque - friction_output.

    Valid for deformations that are small against r_g. Leaves out clearance of mesh and bearing (stiffness.Backlash has play
    in the flexspline's spring alone) and every mode of the flexspline beside torsion and the radial one. The wave generator
    needs an input_inertia. Where the kinematic error has a pitch radius and a pressure angle, too, they must be those of
    the stages. No catalogue gives these stiffnesses: they are calculated, or assumed. The bodies vibrate at some 1e4 to 1e5
    rad/s. Where dampers hold every body, fixed steps need not follow that, but what springs vary and bend by: a run with
    longer ones is refused, and told how long they may be.

    >>> import strainwave as sw
    >>> structure = sw.structure.Staged(pitch_radius=25e-3, bearing_stiffness=5e7, mesh_stiffness=1e8,
    ...     coupling_stiffness=5e3, circular_spline_stiffness=1e5, radial_mass=0.032, flexspline_inertia=2e-5,
    ...     circular_spline_inertia=3e-4)
    >>> gear = sw.Gear(structure=structure, input_inertia=8e-6)
    >>> gear.structure.mesh_stiffness
    100000000.0

    Parameters
    ----------
    pitch_radius: Pitch radius r_g [m], in (0, 1]; required
    pressure_angle: Pressure angle alpha_t of the teeth [rad], in [0.01, 1.5]; default 0.3490658503988659
    coupling_stiffness: Stiffness K_WG between input shaft and wave generator [N.m/rad], in (0, inf); required
    coupling_damping: Damping c_WG there [N.m.s/rad], in [0, inf); default 0.0
    bearing_stiffness: Radial stiffness K_b of the wave generator's bearing [N/m], in (0, inf); required
    bearing_damping: Damping c_b of that bearing [N.s/m], in [0, inf); default 0.0
    mesh_stiffness: Stiffness K_m of the mesh, along its line of action [N/m], in (0, inf); required
    mesh_damping: Damping c_m of the mesh [N.s/m], in [0, inf); default 0.0
    circular_spline_stiffness: Stiffness K_CS between circular spline and output shaft, or housing if that spline is fixed [N.m/rad], in (0, inf); required
    circular_spline_damping: Damping c_CS there [N.m.s/rad], in [0, inf); default 0.0
    radial_mass: Mass m_r of the flexspline's ring that moves radially [kg], in (0, inf); required
    flexspline_inertia: Inertia J_FS of the flexspline's ring, about its axis [kg.m2], in (0, inf); required
    circular_spline_inertia: Inertia J_CS of the circular spline [kg.m2], in (0, inf); required
    coupling_variation: How K_WG varies as the wave generator turns; default Constant()
    bearing_variation: How K_b varies; default Constant()
    mesh_variation: How K_m varies; default Constant()
    circular_spline_variation: How K_CS varies; default Constant()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document A, eq. (1), with the relations that it leaves out, corrected (errata E-A1 to E-A6); the circular spline fixed, varying springs and the default values are assumed
    """

    def __init__(self, *, pitch_radius: float, pressure_angle: float = ..., coupling_stiffness: float, coupling_damping: float = ..., bearing_stiffness: float, bearing_damping: float = ..., mesh_stiffness: float, mesh_damping: float = ..., circular_spline_stiffness: float, circular_spline_damping: float = ..., radial_mass: float, flexspline_inertia: float, circular_spline_inertia: float, coupling_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ..., bearing_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ..., mesh_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ..., circular_spline_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, pitch_radius: float = ..., pressure_angle: float = ..., coupling_stiffness: float = ..., coupling_damping: float = ..., bearing_stiffness: float = ..., bearing_damping: float = ..., mesh_stiffness: float = ..., mesh_damping: float = ..., circular_spline_stiffness: float = ..., circular_spline_damping: float = ..., radial_mass: float = ..., flexspline_inertia: float = ..., circular_spline_inertia: float = ..., coupling_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ..., bearing_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ..., mesh_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ..., circular_spline_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ...) -> Staged:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def pitch_radius(self) -> float:
        """Pitch radius r_g [m]"""

    @property
    def pressure_angle(self) -> float:
        """Pressure angle alpha_t of the teeth [rad]"""

    @property
    def coupling_stiffness(self) -> float:
        """Stiffness K_WG between input shaft and wave generator [N.m/rad]"""

    @property
    def coupling_damping(self) -> float:
        """Damping c_WG there [N.m.s/rad]"""

    @property
    def bearing_stiffness(self) -> float:
        """Radial stiffness K_b of the wave generator's bearing [N/m]"""

    @property
    def bearing_damping(self) -> float:
        """Damping c_b of that bearing [N.s/m]"""

    @property
    def mesh_stiffness(self) -> float:
        """Stiffness K_m of the mesh, along its line of action [N/m]"""

    @property
    def mesh_damping(self) -> float:
        """Damping c_m of the mesh [N.s/m]"""

    @property
    def circular_spline_stiffness(self) -> float:
        """
        Stiffness K_CS between circular spline and output shaft, or housing if that spline is fixed [N.m/rad]
        """

    @property
    def circular_spline_damping(self) -> float:
        """Damping c_CS there [N.m.s/rad]"""

    @property
    def radial_mass(self) -> float:
        """Mass m_r of the flexspline's ring that moves radially [kg]"""

    @property
    def flexspline_inertia(self) -> float:
        """Inertia J_FS of the flexspline's ring, about its axis [kg.m2]"""

    @property
    def circular_spline_inertia(self) -> float:
        """Inertia J_CS of the circular spline [kg.m2]"""

    @property
    def coupling_variation(self) -> strainwave.variation.Constant | strainwave.variation.Periodic:
        """How K_WG varies as the wave generator turns"""

    @property
    def bearing_variation(self) -> strainwave.variation.Constant | strainwave.variation.Periodic:
        """How K_b varies"""

    @property
    def mesh_variation(self) -> strainwave.variation.Constant | strainwave.variation.Periodic:
        """How K_m varies"""

    @property
    def circular_spline_variation(self) -> strainwave.variation.Constant | strainwave.variation.Periodic:
        """How K_CS varies"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'staged'

    source: str = ...

    fields: tuple[dict[str, Any], ...]
