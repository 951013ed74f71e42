"""What load, ratio, material, preload and temperature do to a loop, modelled and measured."""
