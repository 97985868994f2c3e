"""Force, area, pull-off and loss of adhesive maps by summits, hills and adhesive boundary elements."""
