module example/rank

go 1.21
