"""Influence of load, ratio, material, preload and temperature on a loop, modelled and measured."""
