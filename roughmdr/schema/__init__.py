"""Declaration of sections of a scene: units, checked quantities, faults and their wording."""
