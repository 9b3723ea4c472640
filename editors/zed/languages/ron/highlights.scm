[(line_comment) (block_comment)] @comment
[(string) (char)] @string
(escape_sequence) @string.escape
[(integer) (float)] @number
(boolean) @boolean
(struct_name) @type
(enum_variant) @type
(struct_entry . (identifier) @property)
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
["," ":"] @punctuation.delimiter
