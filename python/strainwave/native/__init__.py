"""Compiled code for one drive: its static type, the machine's compiler, and the kernels that were compiled before."""
