"""Interface to the compiled kernel, and the numbers, names and files that all rooms use.

Text enters the kernel as UTF-8 bytes and leaves it in byte buffers. No other room imports the
extensions; `measure` needs the one in quadruple precision.
"""
