"""The paper's straight-line identification of the lumped model, stage by stage."""
