"""Files of recorded ground motions: formats of the networks, lists, suites.

Formats that the kernel reads (AT2, one or two columns) are validated by the kernel.
"""
