#pragma once

/// Titles of the documents that several models follow, as their `source` states them; docs/validation/errata.md lists what is
/// wrong in them. Other works are named by keys of docs/theory/references.md.
#define SW_REVIEW "\"Advances in Dynamic Modeling of Strain Wave Gear Systems\""
#define SW_POSITION_ARTICLE "\"Analysis of a Mathematical Model for Precise Position Control in Strain Wave Gears\""
#define SW_ACTUATOR_PAPER                                                                                                          \
    "\"On the effects of Strain Wave Gear kinematic errors on the behaviour of an Electro-Mechanical Flight control Actuator for " \
    "eVTOL aircrafts\""
#define SW_TORSION_ARTICLE "\"Harmonic Drive Torsional Stiffness: Measurement and Hysteresis Analysis\""
