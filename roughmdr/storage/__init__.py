"""Labelled arrays, and the netCDF files that hold them: read, validated, and written whole or not at all."""
