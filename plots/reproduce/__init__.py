"""The paper's figures and claims, computed again and judged (tools/run reproduce)."""
