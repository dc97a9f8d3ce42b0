!> Numerical description of a scene: its effects with loops, and the positions of their coefficients
!> and states. Runs of one scene differ only in the values of the coefficients.
module rwmf_model_scene
   implicit none
   private

   public :: scene_t, term_t, add_term, is_same_scene
   public :: force_parts_t, force_parts_of, demand_list_t
   public :: frame_term, axis_term, line_term, chord_term, rise_term, first_wall
   public :: elsewhere, under_corner, through_link, in_cable, on_weight

   integer, parameter :: frame_term = -1
   integer, parameter :: axis_term = -2
   !! tendons along the wall's axis; as the next three, of vertical elements
   integer, parameter :: line_term = -3
   !! straight tendons
   integer, parameter :: chord_term = -4
   !! devices under the base
   integer, parameter :: rise_term = -5
   !! restraints and couplings
   integer, parameter :: elsewhere = 0
   !! the loop acts along several paths, as floors, leaning columns and hinges do
   integer, parameter :: under_corner = 1
   !! along the chord of the lifting corner
   integer, parameter :: through_link = 2
   integer, parameter :: in_cable = 3
   integer, parameter :: on_weight = 4
   integer, parameter :: first_wall = 2
   !! column of the first coefficient of the wall; column 1 is 1, or 0 while the wall is held

   !> Lane loop that adds to the equation of motion.
   type :: term_t
      integer :: effect = 0
      !! number of the effect (`rwmf_model_effects_numbers`), or one of the `_term` numbers
      integer :: n = 0
      !! number of its parts (floors)
      integer :: law = 0
      !! law of its loop
      integer :: n_coef = 0
      !! number of its coefficients
      integer :: n_states = 0
      !! number of its states, or of another effect's states that it reads
      integer :: coef = 1
      !! column of its first coefficient
      integer :: state = 1
      !! index of its first state
      integer :: floors = 0
      !! index of the first state of floors on link springs beside a bending wall; 0 for none
      integer :: acts = elsewhere
      !! path of its force to the wall
      logical :: has_springs = .false.
      !! its coefficients change with the branches of springs with memory
   end type term_t

   !> Loops of a scene in their order.
   type :: scene_t
      logical :: has_wall = .false.
      integer :: n = 2
      !! number of states
      integer :: n_coef = 1
      !! number of coefficients
      type(term_t), allocatable :: terms(:)
      integer :: bent = 0
      !! place of the term of a wall that bends: its loop changes the kinematics before all others,
      !! and its states follow theta'' after them; 0 for none
   end type scene_t

   !> Loops of a scene grouped by the path of their forces to the wall, each group with the columns
   !> of the whole scene.
   type :: force_parts_t
      logical :: is_complete = .false.
      !! no other loop exerts a force on the wall or on the ground
      logical :: has_shear_key = .false.
      !! a shear key, not friction, carries the horizontal force on the base
      type(scene_t) :: through_link
      type(scene_t) :: under_corner
      !! along the chord of the lifting corner
      type(scene_t) :: in_cable
   end type force_parts_t

   !> Demands of a building that a loop over lanes computes.
   type :: demand_list_t
      integer :: floors = 0
      !! number of floors
      integer :: drifts = 0
      !! number of storey drifts
      logical :: has_sections = .false.
      !! with the largest shear and moment along the wall
   end type demand_list_t

contains

   !> True if two scenes have the same loops with the same coefficients and states.
   pure logical function is_same_scene(one, other) result(is_same)
      type(scene_t), intent(in) :: one
      type(scene_t), intent(in) :: other

      is_same = (one%has_wall .eqv. other%has_wall) .and. one%n == other%n &
         .and. one%n_coef == other%n_coef .and. size(one%terms) == size(other%terms)
      if (.not. is_same) return
      is_same = all(one%terms%effect == other%terms%effect .and. one%terms%n == other%terms%n &
         .and. one%terms%law == other%terms%law .and. one%terms%coef == other%terms%coef &
         .and. one%terms%state == other%terms%state)
   end function is_same_scene

   !> Group the loops of a scene by the path of their forces.
   pure type(force_parts_t) function force_parts_of(scene) result(parts)
      type(scene_t), intent(in) :: scene
      !! scene with a rocking wall or without a wall

      parts%is_complete = all(scene%terms%acts /= elsewhere)
      parts%through_link = part_of(scene, through_link)
      parts%under_corner = part_of(scene, under_corner)
      parts%in_cable = part_of(scene, in_cable)
   end function force_parts_of

   !> Select the loops of a scene whose forces act along one path.
   pure type(scene_t) function part_of(scene, acts) result(part)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: acts

      part = scene_t(scene%has_wall, scene%n, scene%n_coef, pack(scene%terms, scene%terms%acts &
         == acts))
   end function part_of

   !> Append a loop with its coefficients and states to a scene.
   pure subroutine add_term(scene, term)
      type(scene_t), intent(inout) :: scene
      type(term_t), intent(in) :: term
      !! loop whose positions of coefficients and states are not yet set

      scene%terms = [scene%terms, term]
      associate (added => scene%terms(size(scene%terms)))
         added%coef = scene%n_coef + 1
         added%state = scene%n + 1
         scene%n_coef = scene%n_coef + added%n_coef
         scene%n = scene%n + added%n_states
      end associate
   end subroutine add_term

end module rwmf_model_scene
