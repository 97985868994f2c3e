"""Is every answer right, or refused for a reason, when stiff, soft, small, steep or close to the fold?"""
