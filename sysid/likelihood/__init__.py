"""How probable measured loops are under a model: noise, errors of the rig and of the laws."""
