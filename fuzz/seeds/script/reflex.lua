local seen = wait_for(function() return distance("a", "b") < 1 end, 0.2)
parallel(function() grab("a", "b", 0.2, {1, 0}) end, function() chase("b", "p", 0.1) end)
move("a", vec(0.5, 0.5), 0.1)
release("a")
