"""The folder of a campaign: manifest, shards of rows, the table over them."""
