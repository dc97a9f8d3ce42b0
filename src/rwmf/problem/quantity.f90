!> A row of the table of output quantities, and the observations that a run may need.
module rwmf_problem_quantity
   implicit none
   private

   public :: quantity_t, key_length
   public :: of_displacement, of_velocity, of_storeys, of_reactions, of_demands, of_energy
   public :: of_envelopes, of_verification

   integer, parameter :: key_length = 52
   !! length of the longest key: that of a sensitivity

   ! quantity_rows.table explains the observations
   character(*), parameter :: of_displacement = 'displacement'
   character(*), parameter :: of_velocity = 'velocity'
   character(*), parameter :: of_storeys = 'storeys'
   character(*), parameter :: of_reactions = 'reactions'
   character(*), parameter :: of_demands = 'demands'
   character(*), parameter :: of_envelopes = 'envelopes'
   character(*), parameter :: of_energy = 'energy'
   character(*), parameter :: of_verification = 'verification'

   !> One output quantity.
   type :: quantity_t
      integer :: id
      !! number of the quantity, its row in the table; that of a sensitivity follows the last row
      character(key_length) :: key
      !! name with unit suffix; '{i}' is a placeholder for the floor or storey number, from the
      !! ground up
      character(8) :: unit
      !! '1' for dimensionless numbers, '' for texts
      character(8) :: found
      !! way it is found: 'row' (in each row of a history), 'peak' (located supremum), 'time' (of a
      !! peak), 'end' (final value), 'count' or 'whether'. Others are 'before' (known before the
      !! run), 'axis' (of a grid), 'work' (computational work) and 'error' (estimate or comparison).
      character(32) :: outputs
      !! outputs that contain it: 'history', 'run', 'ordinate' (of a spectrum, on request),
      !! 'spectrum', 'sweep', 'cost'
      character(12) :: group
      !! group of the case that it requires; '' for none
      character(12) :: observed
      !! required observation of a run
      character(56) :: needs
      !! other requirements, in Markdown
      character(80) :: meaning
      integer :: ratio = 0
      !! for a force in N or a moment in N m: number of the same quantity over a weight
      character(8) :: kind = 'real'
      !! 'real', 'int', 'logical', 'text' or 'list'
      character(key_length) :: name = ''
      !! variable of a run's dataset in Python, if not as in `name_of`; '-' for none
   end type quantity_t

end module rwmf_problem_quantity
