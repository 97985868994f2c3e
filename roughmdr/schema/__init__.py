"""How the sections of a scene are declared and read: units, quantities, TOML, and messages about what is wrong."""
