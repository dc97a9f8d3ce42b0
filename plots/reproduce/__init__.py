"""The paper's figures and claims, computed again and judged against engines (rwmf reproduce)."""
