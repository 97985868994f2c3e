"""The conductance of asperities against the stiffness of boundary elements."""
