"""From results to decisions: risk, gradients, design, cost, studies."""
