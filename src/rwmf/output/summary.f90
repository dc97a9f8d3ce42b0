!> The named scalars of one simulation: what `rwmf run --json`, the Python results and
!> `CASE.summary.csv` hold. Here they get their values; which there are, of what kind and in which
!> order says the table of `rwmf_simulation_quantities`.
!>
!> A key that does not apply to the effects in the scene is absent.
module rwmf_output_summary
   use rwmf_core_kinds, only: i8, wp
   use rwmf_input_schema, only: all_groups
   use rwmf_model_history_row, only: numbered
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_shear_frame, only: modal_height, modal_mass, roof_factor
   use rwmf_simulation_quantities, only: all_quantities, find_quantity
   use rwmf_simulation_result, only: energy_t, reaction_extremes_t, result_t
   implicit none
   private

   public :: summary_item_t, summarise, summary_text, list_effects, list_absent_effects, joined

   !> One key with its value.
   type :: summary_item_t
      character(:), allocatable :: key
      !! name with unit suffix
      character(:), allocatable :: kind
      !! 'real', 'int', 'logical', 'text' or 'list'
      real(wp) :: number = 0
      !! of a 'real' [unit of the key]
      integer(i8) :: count = 0
      !! of an 'int'; of a 'logical' 1 for yes
      character(:), allocatable :: text
      !! of a 'text'; of a 'list' its items with a tab between them; '' of the others
      integer :: place
      !! of its quantity in the table
   end type summary_item_t

   character(*), parameter :: tab = achar(9)
contains

   !> All scalars that apply, in the order of the outputs.
   subroutine summarise(case, result, items)
      type(case_t), intent(in) :: case
      type(result_t), intent(in) :: result
      type(summary_item_t), allocatable, intent(out) :: items(:)
      !! (keys)
      character(12), allocatable :: effects(:)

      allocate (items(0))
      call add_maxima(items, result)
      call add_regimes(items, result)
      if (allocated(case%storeys)) call add_storeys(items, case)
      if (allocated(result%reactions)) call add_reactions(items, result%reactions)
      call add_work(items, result)
      ! not within the call below, where gfortran 12 takes the length from memory given back
      effects = list_effects(case)
      call add_item(items, 'effects', text=joined(effects))
      if (allocated(result%warnings)) then
         call add_item(items, 'warnings', text=joined(result%warnings))
      else
         call add_item(items, 'warnings')
      end if
      if (allocated(result%energy)) call add_energy(items, result%energy)
   end subroutine summarise

   !> The summary without its numbers, as lines `key<TAB>kind<TAB>text`.
   pure subroutine summary_text(items, text)
      type(summary_item_t), intent(in) :: items(:)
      character(:), allocatable, intent(out) :: text
      integer :: i

      text = ''
      do i = 1, size(items)
         text = text//items(i)%key//tab//items(i)%kind//tab//items(i)%text//new_line('a')
      end do
   end subroutine summary_text

   !> Names of the effects that are simulated, in the order of the case file's groups.
   function list_effects(case) result(names)
      type(case_t), intent(in) :: case
      character(12), allocatable :: names(:)
      !! (effects)

      call list_groups(case, .true., names)
   end function list_effects

   !> Names of the effects that the scene does not call for.
   function list_absent_effects(case) result(names)
      type(case_t), intent(in) :: case
      character(12), allocatable :: names(:)
      !! (effects)

      call list_groups(case, .false., names)
   end function list_absent_effects

   !> The groups of the scene, those with further keys once, that are present or absent.
   subroutine list_groups(case, is_present, names)
      type(case_t), intent(in) :: case
      logical, intent(in) :: is_present
      character(12), allocatable, intent(out) :: names(:)
      type(case_group_t), allocatable :: groups(:)
      integer :: i

      groups = all_groups()
      allocate (names(0))
      do i = 1, size(groups)
         if (.not. groups(i)%is_of_scene .or. any(groups(:i - 1)%name == groups(i)%name)) cycle
         if (groups(i)%is_present(case) .eqv. is_present) names = &
            [character(12) :: names, groups(i)%name]
      end do
   end subroutine list_groups

   !> Suprema of the response.
   pure subroutine add_maxima(items, result)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      type(result_t), intent(in) :: result

      ! an unallocated component is an absent argument: the key is left out
      call add_real(items, 'u_s_max_m', result%u_s_max)
      call add_real(items, 't_u_s_max_s', result%t_u_s_max)
      call add_real(items, 'theta_max_over_alpha', result%theta_max_over_alpha)
      call add_real(items, 'theta_dot_max_rad_s', result%theta_dot_max)
      call add_real(items, 'cable_force_increment_max_over_m_w_g', result%cable_increment_max)
      call add_real(items, 'cable_prestress_loss_over_m_w_g', result%prestress_loss)
      call add_logical(items, 'cable_ruptured', result%has_ruptured)
      call add_real(items, 'ductility', result%ductility)
      call add_real(items, 'residual_displacement_m', result%residual_displacement)
      call add_real(items, 'theta_end_over_alpha', result%theta_end_over_alpha)
      call add_reals(items, 'storey_{i}_ductility', result%storey_ductility)
      call add_reals(items, 'storey_{i}_residual_drift', result%storey_residual_drift)
   end subroutine add_maxima

   !> The first mode of the frame's storeys, and its share in the mass: what a reduction keeps.
   pure subroutine add_storeys(items, case)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      type(case_t), intent(in) :: case

      associate (frame => case%storeys%frame)
         call add_real(items, 'T_s_s', case%frame%T_s)
         call add_real(items, 'modal_mass_over_m_w', modal_mass(frame, 1))
         call add_real(items, 'mass_participation', modal_mass(frame, 1)/sum(frame%m))
         call add_real(items, 'modal_height_m', modal_height(frame, 1))
         call add_real(items, 'roof_factor', roof_factor(frame, 1))
      end associate
   end subroutine add_storeys

   !> Impacts, lift-offs, overturning and collapse.
   pure subroutine add_regimes(items, result)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      type(result_t), intent(in) :: result

      if (result%has_impacts) then
         call add_count(items, 'impacts', result%impacts)
         call add_count(items, 'lift_offs', result%lift_offs)
         call add_logical(items, 'overturned', result%overturned)
      end if
      call add_logical(items, 'collapsed', result%collapsed)
      call add_real(items, 't_collapse_s', result%t_collapse)
      call add_real(items, 'e', result%e)
      call add_real(items, 'e_max', result%e_max)
   end subroutine add_regimes

   !> What the foundation bears.
   pure subroutine add_reactions(items, reactions)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      type(reaction_extremes_t), intent(in) :: reactions

      call add_real(items, 'base_shear_max_over_weight', reactions%base_shear_max)
      call add_real(items, 't_base_shear_max_s', reactions%t_base_shear_max)
      call add_real(items, 'pivot_normal_min_over_m_w_g', reactions%normal_min)
      call add_real(items, 't_pivot_normal_min_s', reactions%t_normal_min)
      call add_logical(items, 'pivot_lifts', reactions%pivot_lifts)
      call add_real(items, 'friction_demand_max', reactions%demand_max)
      call add_real(items, 't_friction_demand_max_s', reactions%t_demand_max)
      call add_logical(items, 'friction_exceeded', reactions%is_exceeded)
      call add_real(items, 't_friction_exceeded_s', reactions%t_exceeded)
      call add_real(items, 'wall_drift_max', reactions%wall_drift_max)
      call add_real(items, 'frame_drift_max', reactions%frame_drift_max)
   end subroutine add_reactions

   !> The ledger: its parts in the end, and what they miss.
   pure subroutine add_energy(items, energy)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      type(energy_t), intent(in) :: energy
      integer :: i

      do i = 1, size(energy%names)
         call add_real(items, trim(energy%names(i)), energy%values(i))
      end do
      call add_real(items, 'energy_balance_relative', energy_balance(energy))
   end subroutine add_energy

   !> What the integration took.
   pure subroutine add_work(items, result)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      type(result_t), intent(in) :: result

      call add_count(items, 'steps', result%steps)
      call add_count(items, 'rhs_evaluations', result%rhs_evaluations)
      call add_real(items, 'seconds', result%seconds)
      call add_item(items, 'method', text=result%method)
      call add_real(items, 'rtol', result%rtol)
      call add_real(items, 'estimated_relative_error', result%estimated_relative_error)
      call add_real(items, 'estimate_seconds', result%estimate_seconds)
      call add_real(items, 'sensitivity', result%sensitivity)
   end subroutine add_work

   !> Residual of the energy ledger over initial plus largest input energy [-].
   pure real(wp) function energy_balance(energy)
      type(energy_t), intent(in) :: energy
      real(wp) :: residual
      real(wp) :: scale

      residual = energy%final + energy%viscous + energy%impact + energy%hysteretic &
         - energy%initial - energy%input
      scale = abs(energy%initial) + energy%input_max
      energy_balance = 0.0_wp
      if (scale > 0.0_wp) energy_balance = abs(residual)/scale
   end function energy_balance

   !> Add a real, unless it is absent.
   pure subroutine add_real(items, key, value)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      character(*), intent(in) :: key
      real(wp), intent(in), optional :: value

      if (present(value)) call add_item(items, key, number=value)
   end subroutine add_real

   !> Add one real for each storey from the ground up, unless they are absent.
   pure subroutine add_reals(items, pattern, values)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      character(*), intent(in) :: pattern
      !! key with '{i}' in the place of the number
      real(wp), intent(in), optional :: values(:)
      !! (storeys)
      integer :: i

      if (.not. present(values)) return
      do i = 1, size(values)
         call add_item(items, pattern, number=values(i), storey=i)
      end do
   end subroutine add_reals

   !> Add a counter.
   pure subroutine add_count(items, key, value)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      character(*), intent(in) :: key
      integer(i8), intent(in) :: value

      call add_item(items, key, count=value)
   end subroutine add_count

   !> Add a yes or no, unless it is absent.
   pure subroutine add_logical(items, key, value)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      character(*), intent(in) :: key
      logical, intent(in), optional :: value

      if (present(value)) call add_item(items, key, count=merge(1_i8, 0_i8, value))
   end subroutine add_logical

   !> Add one item behind those that come before it in the table; a key that is not in the table is
   !> not added.
   pure subroutine add_item(items, key, number, count, text, storey)
      type(summary_item_t), allocatable, intent(inout) :: items(:)
      character(*), intent(in) :: key
      real(wp), intent(in), optional :: number
      !! [unit of the key]
      integer(i8), intent(in), optional :: count
      character(*), intent(in), optional :: text
      integer, intent(in), optional :: storey
      !! its number, for a key with '{i}'
      type(summary_item_t), allocatable :: grown(:)
      integer :: place
      integer :: n

      place = 1
      if (size(items) > 0) place = items(size(items))%place
      place = find_quantity(key, near=place)
      if (place == 0) return
      n = findloc(items%place > place, .true., dim=1) - 1
      if (n < 0) n = size(items)
      allocate (grown(size(items) + 1))
      grown(:n) = items(:n)
      grown(n + 2:) = items(n + 1:)
      grown(n + 1)%place = place
      grown(n + 1)%key = key
      if (present(storey)) grown(n + 1)%key = trim(numbered(key, storey))
      grown(n + 1)%kind = trim(all_quantities(place)%kind)
      grown(n + 1)%text = ''
      if (present(number)) grown(n + 1)%number = number
      if (present(count)) grown(n + 1)%count = count
      if (present(text)) grown(n + 1)%text = text
      call move_alloc(grown, items)
   end subroutine add_item

   !> Length of the items of a list with a tab between them.
   pure integer function joined_length(list) result(length)
      character(*), intent(in) :: list(:)
      integer :: i

      length = max(0, size(list) - 1)
      do i = 1, size(list)
         length = length + len_trim(list(i))
      end do
   end function joined_length

   !> The items of a list with a tab between them.
   pure function joined(list) result(text)
      character(*), intent(in) :: list(:)
      character(joined_length(list)) :: text
      integer :: last
      integer :: i

      last = 0
      do i = 1, size(list)
         if (i > 1) text(last + 1:last + 1) = tab
         if (i > 1) last = last + 1
         text(last + 1:last + len_trim(list(i))) = list(i)
         last = last + len_trim(list(i))
      end do
   end function joined

end module rwmf_output_summary
