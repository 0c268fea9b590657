"""The chapters' notebooks as data: their exercises, their marked cells, the definitions in them."""
