"""Kernels in C++ that frames are made with, behind typed functions on NumPy arrays."""
