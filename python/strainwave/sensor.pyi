"""What a controller sees a quantity by."""

from typing import Any


class Ideal:
    """
    A sensor that shows what there is.

    .. math:: y = x

    >>> from strainwave.sensor import Ideal
    >>> Ideal()
    Ideal()

    Parameters
    ----------

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /) -> Ideal:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'ideal'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class Gain:
    """
    A sensor that shows too much or too little, at once.

    .. math:: y = g x + y_0

    with g = gain, y_0 = offset.

    >>> from strainwave.sensor import Gain
    >>> Gain(gain=1.02, offset=0.05).gain
    1.02

    Parameters
    ----------
    gain: Reading per true value; default 1.0
    offset: Reading where the true value is 0, in the unit of what it measures; default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition; document A takes current sensors of order zero
    """

    def __init__(self, *, gain: float = ..., offset: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gain: float = ..., offset: float = ...) -> Gain:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def gain(self) -> float:
        """Reading per true value"""

    @property
    def offset(self) -> float:
        """Reading where the true value is 0, in the unit of what it measures"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'gain'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class FirstOrder:
    """
    A sensor that follows with a lag.

    .. math:: \\tau \\dot y = x - y

    with tau = time_constant. At the start of a run it has settled.

    >>> from strainwave.sensor import FirstOrder
    >>> FirstOrder(time_constant=2e-3).time_constant
    0.002

    Parameters
    ----------
    time_constant: Time constant tau [s], in (0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition; document A takes speed sensors of first order
    """

    def __init__(self, *, time_constant: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, time_constant: float = ...) -> FirstOrder:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def time_constant(self) -> float:
        """Time constant tau [s]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'first_order'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class SecondOrder:
    """
    A sensor that follows like a damped oscillator.

    .. math:: \\ddot y = \\omega_0^2\\,(x - y) - 2 \\zeta \\omega_0 \\dot y

    with omega_0 = natural_frequency, zeta = damping_ratio. It lags a steady motion by 2 zeta / omega_0 seconds.
    At the start of a run it has settled. Steps of a fixed length must not be longer than 1 / omega_0.

    >>> from strainwave.sensor import SecondOrder
    >>> SecondOrder(natural_frequency=1200.0).damping_ratio
    0.7

    Parameters
    ----------
    natural_frequency: Natural frequency omega_0 [rad/s], in (0, inf); required
    damping_ratio: Damping ratio zeta, in [0, inf); default 0.7

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition; document A takes position sensors of second order
    """

    def __init__(self, *, natural_frequency: float, damping_ratio: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, natural_frequency: float = ..., damping_ratio: float = ...) -> SecondOrder:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def natural_frequency(self) -> float:
        """Natural frequency omega_0 [rad/s]"""

    @property
    def damping_ratio(self) -> float:
        """Damping ratio zeta"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'second_order'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class Encoder:
    """
    An encoder: it counts, from an offset, and its disc sits off centre.

    .. math:: y = q \\operatorname{round}\\left(\\frac{x + x_0 + a \\sin(x + \\varphi)}{q}\\right), \\qquad q = \\frac{2 \\pi}{N}

    with x the angle, N = counts per revolution, after interpolation, x_0 = offset, a = eccentricity, phi = eccentricity_phase.
    A controller that is not sampled jumps with each count: steps of a fixed length do not see when; adaptive steps then become
    very short. Noise around an encoder is added after counting. Derivatives ignore the rounding.

    >>> from strainwave.sensor import Encoder
    >>> Encoder(counts=2**17, eccentricity=1e-5).offset
    0.0

    Parameters
    ----------
    counts: Counts N per revolution, in [1, inf); required
    offset: Added to the angle [rad]; default 0.0
    eccentricity: Amplitude a of the error once per revolution [rad]; default 0.0
    eccentricity_phase: Phase phi of that error [rad]; default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, counts: float, offset: float = ..., eccentricity: float = ..., eccentricity_phase: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, counts: float = ..., offset: float = ..., eccentricity: float = ..., eccentricity_phase: float = ...) -> Encoder:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def counts(self) -> float:
        """Counts N per revolution"""

    @property
    def offset(self) -> float:
        """Added to the angle [rad]"""

    @property
    def eccentricity(self) -> float:
        """Amplitude a of the error once per revolution [rad]"""

    @property
    def eccentricity_phase(self) -> float:
        """Phase phi of that error [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'encoder'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class Delayed:
    """
    A sensor whose value arrives late.

    .. math:: y = \\left(\\frac{1 - s \\delta / 8}{1 + s \\delta / 8}\\right)^4 x \\approx x(t - \\delta)

    with x what the law shows, delta = delay. What passes keeps its size. The phase lacks 0.52 percent of that of the delay at
    the frequency 1 / delta [rad/s], 2.01 percent at 2 / delta, and less at lower ones. A jump passes at once, and turns up
    again smeared over the time around delta: for what jumps, the delay of a sampled controller is exact. At the start of a
    run it has settled. Steps of a fixed length must not be longer than delta / 8.

    >>> from strainwave.sensor import Delayed, Encoder
    >>> Delayed(law=Encoder(counts=8192), delay=2e-3).law.counts
    8192.0

    Parameters
    ----------
    law: The sensor without delay; default Ideal()
    delay: Delay delta [s], in (0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Pade approximation of a delay, in four equal sections: FranklinPowellEmamiNaeini2002, chapter 5
    """

    def __init__(self, *, law: Ideal | Gain | FirstOrder | SecondOrder | Encoder = ..., delay: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: Ideal | Gain | FirstOrder | SecondOrder | Encoder = ..., delay: float = ...) -> Delayed:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> Ideal | Gain | FirstOrder | SecondOrder | Encoder:
        """The sensor without delay"""

    @property
    def delay(self) -> float:
        """Delay delta [s]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'delayed'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class Noisy:
    """
    A sensor with noise: a flat spectrum up to a bandwidth, the same for the same seed.

    .. math:: y = x + A \\sqrt{\\frac{2}{N}} \\sum_{k=1}^{N} \\cos(2 \\pi f_k t + \\varphi_k)

    with x what the law shows, t the time since the start of the run, A = amplitude. The band from 0 to bandwidth has N = 32
    equal cells; each holds one frequency f_k, its place in the cell and its phase phi_k drawn by ``seed``. A smooth function of
    time: no step length and no method changes it. Its values are close to Gaussian. Samples that are 1 / (2 bandwidth)
    apart, or a multiple of that, are close to independent. Steps must resolve the bandwidth. Sensors that are to differ need
    different seeds.

    >>> from strainwave.sensor import FirstOrder, Noisy
    >>> Noisy(law=FirstOrder(time_constant=1e-3), amplitude=0.02, bandwidth=500.0, seed=7).amplitude
    0.02

    Parameters
    ----------
    law: The sensor without noise; default Ideal()
    amplitude: Root mean square A, in the unit of what it measures, in [0, inf); required
    bandwidth: Highest frequency of the noise [Hz], in (0, inf); default 1000.0
    seed: Whole number that says which of all such noises it is, in [0, 16777215]; default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    spectral representation: ShinozukaDeodatis1991; random numbers: WichmannHill1982
    """

    def __init__(self, *, law: Ideal | Gain | FirstOrder | SecondOrder | Encoder | Delayed = ..., amplitude: float, bandwidth: float = ..., seed: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: Ideal | Gain | FirstOrder | SecondOrder | Encoder | Delayed = ..., amplitude: float = ..., bandwidth: float = ..., seed: float = ...) -> Noisy:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> Ideal | Gain | FirstOrder | SecondOrder | Encoder | Delayed:
        """The sensor without noise"""

    @property
    def amplitude(self) -> float:
        """Root mean square A, in the unit of what it measures"""

    @property
    def bandwidth(self) -> float:
        """Highest frequency of the noise [Hz]"""

    @property
    def seed(self) -> float:
        """Whole number that says which of all such noises it is"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'noisy'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class Quantised:
    """
    A sensor whose reading goes in steps, as behind an analogue-to-digital converter.

    .. math:: y = q \\operatorname{round}\\left(\\frac{x}{q}\\right)

    with x what the law shows, its noise and delay included, q = resolution. A reading that changes much errs by q / sqrt(12)
    in the root mean square. A controller that is not sampled jumps with each step of the reading, as with the counts of an
    Encoder, whose steps are those of an angle. Derivatives ignore the rounding.

    >>> from strainwave.sensor import FirstOrder, Noisy, Quantised
    >>> speed = Noisy(law=FirstOrder(time_constant=1e-3), amplitude=0.05)
    >>> Quantised(law=speed, resolution=0.1).law.amplitude
    0.05

    Parameters
    ----------
    law: The sensor without steps; default Ideal()
    resolution: Step q of the reading, in the unit of what it measures, in (0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition: a uniform quantiser, as an analogue-to-digital converter is
    """

    def __init__(self, *, law: Ideal | Gain | FirstOrder | SecondOrder | Encoder | Delayed | Noisy = ..., resolution: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: Ideal | Gain | FirstOrder | SecondOrder | Encoder | Delayed | Noisy = ..., resolution: float = ...) -> Quantised:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> Ideal | Gain | FirstOrder | SecondOrder | Encoder | Delayed | Noisy:
        """The sensor without steps"""

    @property
    def resolution(self) -> float:
        """Step q of the reading, in the unit of what it measures"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'quantised'

    source: str = ...

    fields: tuple[dict[str, Any], ...]
