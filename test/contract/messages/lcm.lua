-- What generated code needs of the Lua module of LCM, which Debian has not: packing and hashing.
local lcm = {_pack = {}, _hash = {}}

-- LCM's formats, such as ">iq3d", as formats of string.pack(), one for each value.
local formats = {q = "i8", i = "i4", I = "I4", d = "d", B = "B", b = "i1", ["?"] = "B", X = "i8"}

local function each(format)
  local letters = {}
  for count, letter in format:gmatch("(%d*)([%a?])") do
    for _ = 1, tonumber(count) or 1 do
      letters[#letters + 1] = letter
    end
  end
  return ipairs(letters)
end

function lcm._pack.pack(format, ...)
  local values, packed = {...}, {}
  for i, letter in each(format) do
    local value = values[i]
    if letter == "?" then
      value = value and 1 or 0
    elseif letter == "X" then
      value = value.number
    end
    packed[i] = string.pack(">" .. formats[letter], value)
  end
  return table.concat(packed)
end

function lcm._pack.unpack(format, bytes)
  local values, at = {}, 1
  for i, letter in each(format) do
    values[i], at = string.unpack(">" .. formats[letter], bytes, at)
    if letter == "?" then
      values[i] = values[i] ~= 0
    end
  end
  return table.unpack(values)
end

-- A string of a message ends with a NUL, one of Lua does not.
function lcm._pack.prepare_string(text)
  return (text:gsub("%z.*", ""))
end

local hash = {}
hash.__index = hash
hash.__add = function(a, b) return setmetatable({number = a.number + b.number}, hash) end

function hash:rotate(bits)
  self.number = self.number << bits | self.number >> 64 - bits
end

function lcm._hash.new(text)
  return setmetatable({number = math.tointeger(tonumber(text))}, hash)
end

return lcm
