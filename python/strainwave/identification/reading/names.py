"""Meaning of the name of a column: quantity, side, reference or not, and joint; the channels; and names of files."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Literal, NamedTuple

from strainwave.files.labels import Label
from strainwave.files.units import convert, counts, is_share, measures

Quantity = Literal["time", "angle", "twist", "speed", "torque", "current", "voltage", "temperature", "vibration"]
Side = Literal["input", "output"]

UNITS: dict[Quantity, str] = {
    "time": "s", "angle": "rad", "twist": "rad", "speed": "rad/s", "torque": "N.m", "current": "A", "voltage": "V",
    "temperature": "K", "vibration": "m/s2",
}  # fmt: skip

# English, German, French, Spanish and Italian words without accents, and the symbols of textbooks and robots.
QUANTITIES: dict[Quantity, tuple[str, ...]] = {
    "time": (
        "time", "t", "zeit", "zeitstempel", "uhrzeit", "datum", "date", "datetime", "timestamp", "stamp", "temps", "heure",
        "tiempo", "hora", "tempo", "ora", "clock", "elapsed", "ts",
    ),
    "angle": (
        "angle", "position", "positions", "pos", "q", "theta", "th", "phi", "winkel", "lage", "drehwinkel", "stellung",
        "ang", "angulo", "angolo", "posicion", "posizione", "encoder", "enc", "geber", "drehgeber", "resolver", "rotation",
        "counts", "ticks",
    ),
    "twist": ("twist", "torsion", "deflection", "verdrehung", "verdrillung", "deflexion", "torsione", "windup"),
    "speed": (
        "speed", "velocity", "velocities", "vel", "omega", "w", "dq", "qd", "qdot", "qp", "dtheta", "thetadot", "dpos", "dphi",
        "drehzahl", "geschwindigkeit", "winkelgeschwindigkeit", "vitesse", "velocidad", "velocita", "rpm", "n",
        "drehgeschwindigkeit", "velo", "spd",
    ),
    "torque": (
        "torque", "torques", "tau", "trq", "tor", "moment", "drehmoment", "reibmoment", "reibung", "friction", "couple",
        "effort", "efforts", "eff", "frottement", "par", "coppia", "momento", "m",
    ),
    "current": (
        "current", "currents", "cur", "curr", "strom", "i", "iq", "isq", "courant", "corriente", "corrente", "amp", "amps",
        "amperage",
    ),
    "voltage": ("voltage", "volt", "spannung", "u", "v", "uq", "voltaje", "tensione", "vir"),
    "temperature": ("temperature", "temperatures", "temp", "temperatur", "temperatura", "temper"),
    "vibration": ("vibration", "vibrations", "vib", "schwingung", "vibrazione", "vibracion", "accelerometer"),
}  # fmt: skip
BACKDRIVING_WORDS = ("backdriving", "backdrive")  # a torque of the output at which the input begins to turn
# Torques at rest.
STARTING_WORDS = ("starting", "breakaway", "losbrech", "losbrechmoment", "anlauf", "anlaufmoment", *BACKDRIVING_WORDS)
SIDES: dict[Side, tuple[str, ...]] = {
    "input": (
        "motor", "mot", "moteur", "motore", "input", "in", "eingang", "eingangs", "antrieb", "antriebs", "rotor", "wave", "wg",
        "entree", "entrada", "ingresso", "primary",
    ),
    "output": (
        "output", "out", "joint", "jnt", "link", "load", "ausgang", "ausgangs", "abtrieb", "abtriebs", "gelenk", "last", "arm",
        "flexspline", "articulation", "sortie", "salida", "uscita", "secondary", "j", *BACKDRIVING_WORDS,
    ),
}  # fmt: skip
COMMANDED_WORDS = (
    "command", "commanded", "cmd", "reference", "ref", "setpoint", "set", "target", "desired", "des", "demand", "soll",
    "sollwert", "vorgabe", "consigne", "consigna", "riferimento", "referencia", "goal", "computed", "cmptd", "planned",
    "calculated", "calc", "cal",
)  # fmt: skip
NEUTRAL_WORDS = (
    "actual", "act", "measured", "meas", "mes", "msr", "ist", "istwert", "mess", "value", "wert", "signal", "raw", "data",
    "sensor", "state", "states", "side", "seite", "angular", "rotational", "generator", "shaft", "welle", "of", "at", "the",
    "rig", "fb", "feedback", "axis", "achse", "phase", "rms", "ambient", "case", "housing", "oil", "steady", "present",
    "average", "avg", "avr", "mean", "running", "idle", "idling", *STARTING_WORDS,
)  # fmt: skip
# Words of columns that are no measurement of the quantity in their names.
OTHER_WORDS = (
    "error", "fehler", "err", "status", "count", "index", "limit", "max", "min", "std", "sigma", "gain", "constant",
    "acceleration", "acc", "accel", "ddq", "qdd", "jerk", "mode", "flag", "tool", "gripper", "power",
    "id", "ext", "external", "hat", "gravity", "coriolis", "disturbance", "contact", "model",
    "simulated", "predicted", "rne", "ff", "feedforward", "offset", "amplitude", "bus", "supply", "battery", "dclink",
)  # fmt: skip
ACCELERATION_WORDS = {*QUANTITIES["vibration"], "acceleration", "acc", "accel", "beschleunigung"}
STANDARD_GRAVITY = "gn"  # the unit that accelerometers call g, which is a gram elsewhere
ERROR_WORDS = {"error", "err", "fehler", "deviation", "abweichung", "te"}
TRANSMISSION_WORDS = {"te", "transmission", "kinematic"}
DEVIATION_WORDS = ERROR_WORDS | TRANSMISSION_WORDS | {"position", "positioning", "angle", "angular"}
FINE_UNITS = ("arcsec", "arcmin", "\u2033", "\u2032")  # in which a deviation is one of the position
ESTIMATE_WORDS = ("est", "estimated", "estimate")  # of which the column counts only if nothing else has its quantity
# Words for a share of a rated value, each with its unit.
SHARE_UNITS = {"permille": "permille", "promille": "permille", "percent": "%", "pct": "%", "prozent": "%"}
MEASURED_BY_UNIT: tuple[Quantity, ...] = ("angle", "speed", "torque")  # of names that end with their unit and no other word
# Symbols with two meanings at once.
SYMBOLS: dict[str, tuple[str, ...]] = {
    "qm": ("q", "motor"), "qg": ("q", "reference"), "ql": ("q", "link"), "qdes": ("q", "desired"), "qref": ("q", "reference"),
    "dqdes": ("dq", "desired"), "taudes": ("tau", "desired"), "dqm": ("dq", "motor"), "dql": ("dq", "link"),
    "taum": ("tau", "motor"), "tauj": ("tau", "joint"), "thetam": ("theta", "motor"), "thetal": ("theta", "link"),
    "im": ("i", "motor"), "um": ("u", "motor"), "jpos": ("joint", "pos"), "jvel": ("joint", "vel"), "jtor": ("joint", "torque"),
    "jtau": ("joint", "tau"), "jcur": ("joint", "current"), "mpos": ("motor", "pos"), "mvel": ("motor", "vel"),
    "qmsr": ("q", "measured"), "qcmd": ("q", "command"), "macur": ("motor", "axis", "current"),
    "aipos": ("axis", "actual", "pos"), "aspos": ("axis", "soll", "pos"),
}  # fmt: skip
# An index behind a symbol, as in q_m.
INDEX_LETTERS = {"m": "motor", "l": "link", "d": "desired", "r": "reference", "a": "actual"}
MAX_WORDS_TO_INDEX = 2  # from a symbol, as in tau_J_d
EFFORT_WORDS = {"effort", "efforts", "eff"}  # words of robots for a torque or, with its unit, a current
ROBOT_WORDS = ("q", "dq", "qd", "qdot", "qp", "tau", *EFFORT_WORDS)  # what robots call their joints' channels

QUANTITY_OF: dict[str, Quantity] = {word: quantity for quantity, words in QUANTITIES.items() for word in words}
_SIDE_OF: dict[str, Side] = {word: side for side, words in SIDES.items() for word in words}
_KNOWN_WORDS = (*QUANTITY_OF, *_SIDE_OF, *COMMANDED_WORDS, *NEUTRAL_WORDS, *OTHER_WORDS, *ESTIMATE_WORDS, *SHARE_UNITS)
_PARTS_OF_COMPOUNDS = {word for word in _KNOWN_WORDS if len(word) > 2 and word not in ("par", "the")}
WORD_OF_PHRASE = {
    re.compile(r"(?<![a-z])no[\s_-]*load(?![a-z])", re.IGNORECASE): "idle",
    re.compile(r"(?<![a-z])break[\s_-]away", re.IGNORECASE): "breakaway",
    re.compile(r"(?<![a-z])back[\s_-]driv", re.IGNORECASE): "backdriv",
}  # of two words
_GREEK_LETTERS = str.maketrans({"ω": "omega", "τ": "tau", "θ": "theta", "φ": "phi"})
_UNIT_NAMES = {"rpm": "rpm"}  # words for quantity and unit


class Meaning(NamedTuple):
    """The meaning of the name of a column.

    Args:
        quantity: what is measured, in a unit that measures it
        side: of which shaft; None if the name contains none
        commanded: True for a reference
        which: the rest of the name, as the number of a joint
        unit: the unit in the name, as it is written there
        robot: True for the word of robots for a joint's channel
        estimated: True for an estimate of the quantity, as servo drives export of speeds
    """

    quantity: Quantity
    side: Side | None = None
    commanded: bool = False
    which: str = ""
    unit: str | None = None
    robot: bool = False
    estimated: bool = False


def meaning(label: Label) -> Meaning | None:
    """Return the meaning of the name and unit of a column; None if they have none that is known.

    >>> meaning(Label("Motordrehzahl [U/min]", "Motordrehzahl", "U/min"))
    Meaning(quantity='speed', side='input', commanded=False, which='', unit='U/min', robot=False, estimated=False)
    >>> meaning(Label("joint3_pos_deg", "joint3_pos_deg", None))
    Meaning(quantity='angle', side='output', commanded=False, which='3', unit='deg', robot=False, estimated=False)
    """
    if label.unit is None and (alone := _of_unit_alone(label.name)):
        return alone
    name, unit = (label.name, label.unit) if label.unit else _without_unit(label.name)
    words = words_of(name)
    unit = STANDARD_GRAVITY if unit in ("g", "G") and ACCELERATION_WORDS & set(words) else unit
    sides = [_SIDE_OF[word] for word in words if word in _SIDE_OF]
    if unit is not None and measures(unit, UNITS["vibration"]):
        return Meaning("vibration", sides[-1] if sides else None, unit=unit)
    is_fine = unit in FINE_UNITS or (unit is not None and measures(unit, "rad") and TRANSMISSION_WORDS & set(words))
    if is_fine and set(words) <= DEVIATION_WORDS and ERROR_WORDS & set(words):
        return Meaning("twist", unit=unit)
    if any(word in OTHER_WORDS for word in words):
        return None
    quantity, at = _of_last_part(name, words, unit) or _quantity(words, unit)
    if quantity is None and any(word in COMMANDED_WORDS for word in words):
        quantity = "angle"
    unit = unit or next((SHARE_UNITS[word] for word in words if word in SHARE_UNITS), None)
    if quantity is None or (unit is not None and not _may_be_of(unit, quantity)):
        return None
    words = [
        INDEX_LETTERS.get(word, word) if 0 < place - at <= MAX_WORDS_TO_INDEX else word for place, word in enumerate(words)
    ]
    sides = [_SIDE_OF[word] for word in words if word in _SIDE_OF]
    return Meaning(
        quantity,
        sides[-1] if sides else None,
        any(word in COMMANDED_WORDS for word in words),
        which_of(words),
        unit or next((_UNIT_NAMES[word] for word in words if word in _UNIT_NAMES), None),
        at >= 0 and words[at] in ROBOT_WORDS,
        any(word in ESTIMATE_WORDS for word in words),
    )


def _may_be_of(unit: str, quantity: Quantity) -> bool:
    """True if numbers of a quantity may be in a unit, perhaps with a number to add: of counts, or of a rated value."""
    return measures(unit, UNITS[quantity]) or counts(unit) or (is_share(unit) and quantity in ("torque", "current"))


def _of_last_part(name: str, words: list[str], unit: str | None) -> tuple[Quantity, int] | None:
    """Return the quantity that the last part of a path names, as q in `robot.arm.q_1`, and the place of its word."""
    last = words_of(re.split(r"[./]", name)[-1])
    quantity, at = _quantity(last, unit)
    before = len(words) - len(last)
    return (quantity, before + at) if quantity is not None and before > 0 and at >= 0 and words[before:] == last else None


def _of_unit_alone(name: str) -> Meaning | None:
    """Return the meaning of a name that is nothing but a unit, as in `rpm,Nm`."""
    if len(name) < 2 or name.casefold() in _PARTS_OF_COMPOUNDS - _UNIT_NAMES.keys():
        return None
    quantity = next((each for each, standard in UNITS.items() if measures(name, standard)), None)
    return Meaning(quantity, unit=name) if quantity else None


def meaning_by_unit(label: Label) -> Meaning | None:
    """Return the meaning of a name that means nothing but in its unit, with which it ends; None if it ends with none.

    >>> meaning_by_unit(Label("table_deg", "table_deg", None))
    Meaning(quantity='angle', side=None, commanded=False, which='table', unit='deg', robot=False, estimated=False)
    """
    by_quantity = ((quantity, *_without_unit(label.name, quantity)) for quantity in MEASURED_BY_UNIT)
    by_unit = next(((quantity, rest, unit) for quantity, rest, unit in by_quantity if unit and len(unit) > 1), None)
    if by_unit is None or any(word in OTHER_WORDS for word in words_of(label.name)):
        return None
    quantity, rest, unit = by_unit
    return Meaning(quantity, which=which_of(words_of(rest)), unit=unit)


def words_of(name: str) -> list[str]:
    """Return the words of a name, in small letters without accents; compounds are taken apart.

    >>> words_of("Sollposition Achse2"), words_of("motorCurrent"), words_of("theta_m")
    (['soll', 'position', 'achse', '2'], ['motor', 'current'], ['theta', 'm'])
    """
    plain = unicodedata.normalize("NFKD", name.translate(_GREEK_LETTERS))
    plain = "".join(each for each in plain if not unicodedata.combining(each))
    apart = _one_word(re.sub(r"(?<=[a-z])(?=[A-Z])", "_", plain))
    words: list[str] = []
    for word in re.findall(r"[a-z]+|\d+", apart.casefold()):
        words += SYMBOLS.get(word) or _parts(word) or (word.endswith("s") and _parts(word[:-1])) or [word]
    is_of_drive = words[1:2] == ["q"] and words[0] in ("i", "u")  # i_q and u_q of a field-oriented one
    return [f"{words[0]}q", *words[2:]] if is_of_drive else words


def is_at_rest(name: str) -> bool:
    """True for the name of a torque at which a shaft begins to turn.

    >>> is_at_rest("Starting torque"), is_at_rest("Losbrechmoment"), is_at_rest("running torque")
    (True, True, False)
    """
    return not {*STARTING_WORDS}.isdisjoint(words_of(name))


def _one_word(name: str) -> str:
    """Return a name with one word in place of phrases whose parts mean something else, as the load in no-load.

    >>> _one_word("no-load running torque")
    'idle running torque'
    """
    for phrase, word in WORD_OF_PHRASE.items():
        name = phrase.sub(word, name)
    return name


@lru_cache(maxsize=4096)
def _parts(word: str) -> list[str] | None:
    """Return the words of a compound; None if it is none of known words."""
    if word in _PARTS_OF_COMPOUNDS:
        return [word]
    if len(word) > 60:  # a bound for the work that a text from outside can cause
        return None
    for end in range(len(word) - 3, 2, -1):
        if word[:end] in _PARTS_OF_COMPOUNDS and (rest := _parts(word[end:]) or _parts(word[end:].removeprefix("s"))):
            return [word[:end], *rest]
    return None


def unit_in(name: str, quantity: Quantity) -> str | None:
    """Return the unit of a quantity with which a name ends; None if it ends with none.

    >>> unit_in("table_deg", "angle"), unit_in("drive", "angle")
    ('deg', None)
    """
    return _without_unit(name, quantity)[1]


def _without_unit(name: str, of: Quantity | None = None) -> tuple[str, str | None]:
    """Return a name without its last words, if these are a unit of what the others name, and the unit.

    As of `torque_Nm`, `speed rad/s`, `vel_deg_s`, `pos_deg_1`. If the quantity is known, the others may name anything.
    """
    words = re.split(r"[_\s.]+", name.strip())
    number = [words.pop()] if len(words) > 2 and words[-1].isdigit() else []
    for count in (3, 2, 1):
        if len(words) <= count or (count == 3 and words[-2].casefold() != "per"):
            continue
        unit = "/".join(word for word in words[-count:] if word.casefold() != "per")
        if any(re.fullmatch(r"J?|[A-Za-z]?\d+", word) for word in words[-count:]):  # of a joint: its number, as A1, or the word
            continue
        rest = "_".join([*words[:-count], *number]).removesuffix("_in")  # position in rad
        named = words_of(rest)
        quantity = of or ("current" if _is_current(named, unit) else _quantity(named, None)[0])
        unit = {"nm": "N.m"}.get(unit, unit) if quantity == "torque" else unit
        if unit == "C" and quantity in ("time", "temperature"):  # T_C: no time is in coulombs
            return rest, "degC"
        if quantity is not None and measures(unit, UNITS[quantity]):
            return rest, unit
        if (
            len(unit) > 1
            and set(words_of(rest)) <= {*COMMANDED_WORDS, *NEUTRAL_WORDS} | DEVIATION_WORDS
            and measures(unit, "rad")
        ):
            return rest, unit
    return name, None


def _quantity(words: list[str], unit: str | None) -> tuple[Quantity | None, int]:
    """Return the quantity that words name, and the place of its word; if none does, what the unit measures, and -1."""
    places = [place for place, word in enumerate(words) if word in QUANTITY_OF]
    qualifiers = {*_SIDE_OF, *COMMANDED_WORDS, *NEUTRAL_WORDS}
    places = [place for place in places if len(words[place]) > 1] or [
        place for place in places[:1] if words[place] in ROBOT_WORDS or all(word in qualifiers for word in words[:place])
    ]  # a letter behind another word is an index, but for the q of robots, unless it stands behind a letter, as in i_q
    named = [("current" if _is_current([words[place]], unit) else QUANTITY_OF[words[place]], place) for place in places]
    twist = [each for each in named if each[0] == "twist"]
    torque = [each for each in named if each[0] == "torque"]
    candidates = (twist if not torque else []) or named[::-1]
    if unit is not None:
        candidates = [each for each in candidates if measures(unit, UNITS[each[0]])] or candidates
        fits = [quantity for quantity, standard in UNITS.items() if quantity != "twist" and measures(unit, standard)]
        if fits and not (candidates and measures(unit, UNITS[candidates[0][0]])):
            return (
                (fits[0], places[-1] if places else -1) if not candidates or len(words[candidates[0][1]]) == 1 else (None, -1)
            )
    if not candidates:
        return None, -1
    quantity, place = candidates[0]
    if quantity == "angle" and "dot" in words[place + 1 :]:
        quantity = "speed"
    return quantity, place


def _is_current(words: Sequence[str], unit: str | None) -> bool:
    """True for the effort of a robot in a unit of a current."""
    return unit is not None and not EFFORT_WORDS.isdisjoint(words) and measures(unit, UNITS["current"])


def is_of_joint(name: str, stem: str, joint: str | None = None) -> bool:
    """True for the name of a column with the number of a joint behind a stem; of any joint if it is None.

    >>> is_of_joint("Cur4", "Cur", "4"), is_of_joint("effort[4]", "effort", "J4"), is_of_joint("q_4", "q", "3")
    (True, True, False)
    """
    number = r"\d+" if joint is None else f"0*{re.escape(which_of(words_of(joint)) or joint)}"
    return re.fullmatch(rf"{re.escape(stem)}(?:[_.]?{number}|\[{number}\])", name) is not None


def which_of(words: list[str]) -> str:
    """Return the words of a channel but for quantity and side: the number of a joint, or its name."""
    numbers = [word.lstrip("0") or "0" for word in words if word.isdigit()]
    meant = {*QUANTITY_OF, *_SIDE_OF, *COMMANDED_WORDS, *NEUTRAL_WORDS, *INDEX_LETTERS, *ESTIMATE_WORDS, *SHARE_UNITS, "dot"}
    return ".".join(numbers) or "_".join(word for word in words if word not in meant)


# ---- Channels --------------------------------------------------------------------------------------------------------


class Channel(NamedTuple):
    """A measured quantity of a shaft.

    Args:
        quantity: what is measured
        side: of which shaft; None if the kind of measurement or the other columns determine it
        commanded: True for a reference
        modelled: True for the output of a model
        reflected: True for a motion of the input that is counted at the output: divided by the ratio
        loading: True for the torque that loads a gear while its friction is measured
    """

    quantity: Quantity
    side: Side | None = None
    commanded: bool = False
    modelled: bool = False
    reflected: bool = False
    loading: bool = False

    @property
    def measured(self) -> bool:
        return not (self.commanded or self.modelled or self.loading)

    @property
    def unit(self) -> str:
        return UNITS[self.quantity]


# All channels by name. If a name contains no side, the kind of measurement or the other columns determine it.
CHANNELS: dict[str, Channel] = {
    "time": Channel("time"),
    "command": Channel("angle", commanded=True),
    "voltage": Channel("voltage"),
    "current": Channel("current"),
    "input_torque": Channel("torque", "input"),  # of the motor, at its shaft
    "joint_torque": Channel("torque", "output"),  # of the motor, counted at the output; or of a sensor there
    "rigid_torque": Channel("torque", "output", modelled=True),  # of gravity and of arms that move together, as a model has it
    "input_angle": Channel("angle", "input"),
    "input_speed": Channel("speed", "input"),
    "reflected_angle": Channel("angle", "input", reflected=True),  # of the motor, divided by the ratio, as robots export it
    "reflected_speed": Channel("speed", "input", reflected=True),
    "output_angle": Channel("angle", "output"),
    "output_speed": Channel("speed", "output"),
    "other_angles": Channel("angle", "output"),  # of joints that move too, as numbers or names of columns with commas
    "regressors": Channel("torque", "output", modelled=True),  # of a model of the arm, each per one of its parameters, as above
    "load_torque": Channel("torque", loading=True),  # of a friction table: what loads the gear, counted where the table is
    "twist": Channel("twist"),
    "temperature": Channel("temperature"),
    "vibration": Channel("vibration"),  # of an accelerometer on the housing
    "torque": Channel("torque"),
    "speed": Channel("speed"),
    "angle": Channel("angle"),
}
UNUSED = "unused"  # stands for a channel where a person names columns that are not to be used, with commas
# Other names that people may give.
CHANNEL_ALIASES = {"position": "angle", "output_torque": "joint_torque", "velocity": "speed"}


# ---- Names of files --------------------------------------------------------------------------------------------------


# How people write the units of a speed in names of files, which have neither slashes nor brackets.
SPEED_UNITS_OF_FILES = {
    **dict.fromkeys(("rpm", "upm", "umin", "1min", "min-1", "rev_min"), "rpm"),
    **dict.fromkeys(("dps", "degps", "deg_s", "degs", "deg-s", "deg_per_s", "grad_s"), "deg/s"),
    **dict.fromkeys(("radps", "rad_s", "rads", "rad-s", "rad_per_s"), "rad/s"),
}
_SPEED_IN_NAME = re.compile(
    r"(?<![\w.+-])(?P<sign>[+-]|(?:neg|minus|pos|plus)[ _]?)?(?P<number>[0-9]{1,6}(?:[.p][0-9]{1,9})?)[ _]?"
    rf"(?P<unit>{'|'.join(sorted(map(re.escape, SPEED_UNITS_OF_FILES), key=len, reverse=True))})(?![a-z0-9])"
)


_JOINT_IN_NAME = re.compile(r"(?<![a-z0-9])(?:joint|jnt|gelenk|axis|achse|j|q)[ _-]?0*(?P<number>[0-9]{1,2})(?![0-9a-z.])")


def joint_in(path: Path) -> str:
    """Return the joint in the name of a file; empty if it contains none, or two.

    >>> joint_in(Path("joint_3_trapez.csv")), joint_in(Path("q2_run_1.csv")), joint_in(Path("run_2.csv"))
    ('3', '2', '')
    """
    joints = {match["number"] for match in _JOINT_IN_NAME.finditer(path.stem.casefold())}
    return joints.pop() if len(joints) == 1 else ""


def speed_in(path: Path) -> float | None:
    """Return the speed with its unit in the name of a file [rad/s]; None if it contains none, or two.

    A minus right behind a word may be a hyphen: a number behind it is not taken.

    >>> speed_in(Path("run_-20rpm.csv")), speed_in(Path("J2_0p5_rad_s.txt")), speed_in(Path("run_20.csv"))
    (-2.0943951023931953, 0.5, None)
    """
    speeds = list(_SPEED_IN_NAME.finditer(re.sub(r"_(?=[+-]?[0-9])|_(?=neg|minus|pos|plus)", " ", path.stem.casefold())))
    if len(speeds) != 1:
        return None
    (match,) = speeds
    sign = -1.0 if (match["sign"] or "").startswith(("-", "neg", "minus")) else 1.0
    return sign * convert(float(match["number"].replace("p", ".")), SPEED_UNITS_OF_FILES[match["unit"]], "rad/s")
