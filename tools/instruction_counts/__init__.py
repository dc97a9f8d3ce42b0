"""How many instructions the standard calls take, and whether one has grown (tools/counts)."""
