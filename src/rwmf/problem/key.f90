!> One key of a case file: what the documentation, the validation and the messages say of it.
module rwmf_problem_key
   implicit none
   private

   public :: key_t, required, optional_key, of_kind, dimensional, with_si, usually, belongs_to
   public :: any_real, positive, below_one, not_negative

   character(*), parameter :: any_real = 'any finite number'
   character(*), parameter :: positive = '> 0'
   character(*), parameter :: below_one = '[0, 1)'
   character(*), parameter :: not_negative = '>= 0'

   !> One key. Texts are padded with blanks.
   type :: key_t
      character(12) :: group
      character(20) :: key
      !! as the documentation spells it; letters may be small or capital in a case
      character(9) :: type
      !! 'real', 'real list', 'integer', 'logical', 'choice', 'text' or 'text list'
      character(6) :: unit
      !! of a number; '-' for a ratio, '' for texts and counts
      character(16) :: default
      !! value when it is not given, or the name of the key of the group that has it; '' for none
      logical :: is_required
      !! must be given whenever the group is
      character(104) :: allowed
      !! of a number: `> 0`, `>= 0` or an interval; of a choice: its names
      character(104) :: help
      character(88) :: kinds
      !! of `&motion`: the kinds that the key belongs to; '' for all
      character(16) :: implies
      !! `KEY=VALUE`: what a choice of the same group is when this key is given and the choice is
      !! not; '' for nothing
      character(6) :: si = ''
      !! of a ratio to the mass or to the weight of the wall: its unit once it is multiplied by
      !! that, by the weight for 'N'; '' for others
      character(20) :: gives = ''
      !! of a dimensional key: the key of the group that follows from it; '' for other keys
      character(64) :: needs = ''
      !! keys of the group without which it must not be given, with blanks between; of several with
      !! '|' between them one is enough
      logical :: scales = .false.
      !! it may stand beside the key that it gives, whose values it scales
      character(16) :: usual = ''
      !! range of its magnitude in real buildings, '[low, high]'; beyond it a case gets a warning
   end type key_t

contains

   !> A key that must be given.
   pure type(key_t) function required(group, key, type, unit, allowed, help)
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      character(*), intent(in) :: type
      !! component of `key_t`, as the following ones
      character(*), intent(in) :: unit
      !! of a number; '-' for a ratio, '' for texts and counts
      character(*), intent(in) :: allowed
      !! of a number its range, of a choice its names
      character(*), intent(in) :: help
      !! what it means, for the user

      required = key_t(group, key, type, unit, '', .true., allowed, help, '', '')
   end function required

   !> A key that may be left out.
   pure type(key_t) function optional_key(group, key, type, unit, default, allowed, help, implies)
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      character(*), intent(in) :: type
      !! component of `key_t`, as the following ones
      character(*), intent(in) :: unit
      !! of a number; '-' for a ratio, '' for texts and counts
      character(*), intent(in) :: default
      !! value when it is not given, or the key of the group that has it; '' for none
      character(*), intent(in) :: allowed
      !! of a number its range, of a choice its names
      character(*), intent(in) :: help
      !! what it means, for the user
      character(*), intent(in), optional :: implies
      !! `KEY=VALUE`, what a choice of the group is when this key is given and the choice is not;
      !! absent for none

      optional_key = key_t(group, key, type, unit, default, .false., allowed, help, '', '')
      if (present(implies)) optional_key%implies = implies
   end function optional_key

   !> A key that is a ratio to the mass or to the weight of the wall.
   pure type(key_t) function with_si(si, ratio)
      character(*), intent(in) :: si
      !! component of `key_t`
      type(key_t), intent(in) :: ratio
      !! the key

      with_si = ratio
      with_si%si = si
   end function with_si

   !> A key whose magnitude in real buildings lies in a range.
   pure type(key_t) function usually(range, key)
      character(*), intent(in) :: range
      !! component `usual` of `key_t`
      type(key_t), intent(in) :: key
      !! the key without it

      usually = key
      usually%usual = range
   end function usually

   !> A key in kg, N or Pa that stands for one over the mass or the weight of the wall.
   pure type(key_t) function dimensional(group, key, type, unit, gives, needs, help, &
      allowed)
      character(*), intent(in) :: group
      !! its name, without &
      character(*), intent(in) :: key
      !! its name
      character(*), intent(in) :: type
      !! component of `key_t`, as the following ones
      character(*), intent(in) :: unit
      !! of the number
      character(*), intent(in) :: gives
      !! the key of the group that follows from it
      character(*), intent(in) :: needs
      !! keys of the group without which it must not be given
      character(*), intent(in) :: help
      !! what it means, for the user
      character(*), intent(in), optional :: allowed
      !! range of the number; absent for > 0

      dimensional = key_t(group, key, type, unit, '', .false., positive, help, '', '', '', gives, &
         needs)
      if (present(allowed)) dimensional%allowed = allowed
   end function dimensional

   !> A key of some kinds of motion.
   pure type(key_t) function of_kind(kinds, key, type, unit, default, allowed, help)
      character(*), intent(in) :: kinds
      !! names of the kinds of motion that the key belongs to, with blanks between; '' for all
      character(*), intent(in) :: key
      !! its name
      character(*), intent(in) :: type
      !! component of `key_t`, as the following ones
      character(*), intent(in) :: unit
      !! of a number; '-' for a ratio, '' for texts and counts
      character(*), intent(in) :: default
      !! value when it is not given, or the key of the group that has it; '' for none
      character(*), intent(in) :: allowed
      !! of a number its range, of a choice its names
      character(*), intent(in) :: help
      !! what it means, for the user

      of_kind = key_t('motion', key, type, unit, default, .false., allowed, help, kinds, '')
   end function of_kind

   !> Does the key belong to this kind of motion? Always true in other groups.
   pure logical function belongs_to(key, kind)
      type(key_t), intent(in) :: key
      character(*), intent(in) :: kind
      !! name of a kind of motion, without blanks

      belongs_to = key%kinds == '' .or. index(' '//key%kinds//' ', ' '//kind//' ') > 0
   end function belongs_to

end module rwmf_problem_key
