"""Force and contact area of maps by summits, by hills and by coarse boundary elements, with their run times."""
